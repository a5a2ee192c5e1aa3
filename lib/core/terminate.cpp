// Part of builds without exceptions only (BUSBAR_NO_EXCEPTIONS).
#include <cstdlib>
#include <exception>

// The C++ library of GCC calls this handler in the end. Its own one prints the exception, for which
// it needs a demangler of 50 kB; without exceptions there is nothing to print. A program that links
// the library statically uses the first definition it finds, which is this one; others do not see
// it.
namespace __cxxabiv1 { // NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
extern std::terminate_handler __terminate_handler; // NOLINT(bugprone-reserved-identifier,cert-*)
std::terminate_handler __terminate_handler =
    std::abort; // NOLINT(bugprone-reserved-identifier,cert-*)
} // namespace __cxxabiv1
