#pragma once

#include <type_traits>
#include <utility>

namespace busbar {

template <typename Signature>
class FunctionRef;

/// A callable that is borrowed for the duration of one call: two pointers, never empty, no
/// allocation.
template <typename R, typename... Args>
class FunctionRef<R(Args...)> {
public:
    template <typename F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> &&
             std::is_invocable_r_v<R, F&, Args...>) FunctionRef(F&& function)
        : object_{const_cast<void*>(static_cast<const void*>(&function))},
          call_{[](void* object, Args... args) -> R {
              return (*static_cast<std::remove_reference_t<F>*>(object))(
                  std::forward<Args>(args)...);
          }}
    {
    }

    /// Calls the callable.
    R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

private:
    void* object_;
    R (*call_)(void*, Args...);
};

} // namespace busbar
