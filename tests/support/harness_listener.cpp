// A check that fails shows the account of the test's worlds.
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
