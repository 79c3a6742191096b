#define LANES_NAME _base
#include "lanes.h"
#include "closed_forms.h"
#include "eliminate.h"
#include "descents.h"
#include "followed_rows.h"
#include "ways_down.h"
#include "turned.h"
#include "fronts.h"
