#include <busbar/harness/failing_memory_main.hpp>
