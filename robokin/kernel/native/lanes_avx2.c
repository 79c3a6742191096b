#define LANES_NAME _avx2
#include "lanes.h"
