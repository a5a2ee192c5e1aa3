#pragma once

/// Marks what a shared library offers to programs and to other layers; the rest of it is hidden.
#if defined(__GNUC__)
#define BUSBAR_API __attribute__((visibility("default")))
#else
#define BUSBAR_API
#endif
