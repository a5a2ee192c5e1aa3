#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// What the rules of W588, 6-2-2 ask of a structure or union, with all that lies in it.
struct TypeFacts {
    std::uint64_t values{0};
    std::uint64_t members{0}; // its own
    /// Of structures and unions within one another, itself included.
    std::uint64_t levels{0};
    bool has_matrix{false};
    bool has_union{false};
    bool has_first_index{false};
    /// Types of its members that are structures or unions, each once.
    std::vector<const DerivedType*> inner{};
};

/// The same of a variable.
struct VariableFacts {
    std::uint64_t size{0};
    std::uint64_t values{0};
    std::uint64_t elements{1};
    std::uint64_t members{0};
    std::uint64_t levels{0};
    bool is_matrix_of_structures{false};
    bool has_matrix{false};
    bool has_union{false};
    bool has_first_index{false};
    /// Of a structure or union, or of elements that are.
    const DerivedType* structure{nullptr};
};

/// The facts of a program's types, each found when it is asked for first and only once.
class TypeFactsTable {
public:
    /// `program` must outlive it.
    explicit TypeFactsTable(const ProgramTypes& program)
        : program_{&program}, facts_(program.program().types.size())
    {
    }

    [[nodiscard]] VariableFacts of(const TypeUse& use);
    /// The folded names of structures and unions that `top` is made of, itself included, which are
    /// not in `known`; no further ones once there are more than `room`. `top` may be null.
    [[nodiscard]] std::vector<std::string>
    new_definitions(const DerivedType* top, const std::unordered_set<std::string>& known,
                    std::uint64_t room);

private:
    [[nodiscard]] const TypeFacts& of_type(const DerivedType& type);
    [[nodiscard]] TypeFacts find_facts(const DerivedType& type);
    void add_member(TypeFacts& facts, const DerivedType& type, const TypeUse& use);

    const ProgramTypes* program_;
    /// In the order of Program::types.
    std::vector<std::optional<TypeFacts>> facts_;
};

} // namespace busbar::controller::detail
