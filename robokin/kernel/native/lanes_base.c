#define LANES_NAME _base
#include "lanes.h"
