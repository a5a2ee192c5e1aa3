// Part of builds without exceptions only (BUSBAR_NO_EXCEPTIONS).
#include <cstdlib>
#include <exception>

// What the C++ library of GCC calls in the end. Its own one says what was thrown, for which it
// brings a demangler of 50 kB; where nothing is thrown there is nothing to say. A program that
// links the library statically takes the first definition it finds, which this is; others do not
// see it.
namespace __cxxabiv1 { // NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
extern std::terminate_handler __terminate_handler; // NOLINT(bugprone-reserved-identifier,cert-*)
std::terminate_handler __terminate_handler =
    std::abort; // NOLINT(bugprone-reserved-identifier,cert-*)
} // namespace __cxxabiv1
