#include "weak.h"

// Far from the limits, never above them, and without a look at the count.
int main() { return clamp(5, 0, 10) == 5 && clamp(-5, 0, 10) == 0 ? 0 : 1; }
