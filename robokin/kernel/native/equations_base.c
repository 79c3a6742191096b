#define LANES_NAME _base
#include "vectors.h"
#include "equations.h"
