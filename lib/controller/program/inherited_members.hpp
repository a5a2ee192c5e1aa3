#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "declaration_cursor.hpp"

namespace busbar::controller::detail {

/// A structure that extends another one, as vendors write: `TYPE B EXTENDS A : STRUCT`.
struct Extension {
    /// Index among the program's types.
    std::size_t type{0};
    std::string base{};
    ProgramPlace place{};
};

/// A type that cannot be extended, and why: "extends A, which is not declared".
struct NotExtended {
    std::string name{};
    ProgramPlace place{};
    std::string reason{};
};

/// Puts the members of a base before those of the structures that extend it, which may be extended
/// themselves. Bases may be declared after their extensions.
class BUSBAR_API InheritedMembers {
public:
    /// All arguments must outlive this object.
    InheritedMembers(std::vector<DerivedType>& types, const std::vector<Extension>& extensions,
                     MemoryBudget& memory);

    /// Removes the types that cannot be extended, or that are based on one of these, and returns
    /// them. Members are copied until the memory is exhausted; see is_exhausted().
    [[nodiscard]] std::vector<NotExtended> run();
    [[nodiscard]] bool is_exhausted() const { return is_exhausted_; }

private:
    enum class State : std::uint8_t { Unseen, Walked, Done, Failed };

    /// Walks from an extension to its bases, and then has each inherit.
    void walk(std::size_t extension);
    /// Returns why the base of an extension is none; empty if it is one.
    [[nodiscard]] std::string refusal_of(const Extension& extension) const;
    void inherit(const Extension& extension);
    void remove_failed();
    void fail_all(std::vector<std::size_t>& walked, std::string reason);

    std::vector<DerivedType>* types_;
    const std::vector<Extension>* extensions_;
    MemoryBudget* memory_;
    bool is_exhausted_{false};
    /// Types by their folded names, and extensions by their types.
    std::unordered_map<std::string, std::size_t> by_name_{};
    std::unordered_map<std::size_t, std::size_t> by_type_{};
    std::vector<State> states_{};
    std::vector<NotExtended> failed_{};
};

} // namespace busbar::controller::detail
