#include "tb/iss/machine.h"
