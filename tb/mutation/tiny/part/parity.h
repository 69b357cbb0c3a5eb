#pragma once
inline bool even(int i) { return i % 2 == 0; }
