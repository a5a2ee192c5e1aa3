#pragma once

/// std::chrono's durations, time points and clocks. The calendar, the time zones and the streams of
/// <chrono> are as much again for a compiler to read as all of a first server's headers, and no
/// header uses them: where the standard library has the rest in a header of its own, as GCC's has
/// since version 12, it is that one. A program that uses a calendar includes <chrono>.
#if __has_include(<bits/chrono.h>)
#include <bits/chrono.h>
#else
#include <chrono>
#endif
