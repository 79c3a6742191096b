#define LANES_NAME _avx2
#include "vectors.h"
#include "equations.h"
