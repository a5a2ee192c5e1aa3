#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// The facts about a structure or union, with all its parts, that the rules of W588, 6-2-2 need.
struct TypeFacts {
    std::uint64_t values{0};
    std::uint64_t members{0}; // its own only
    /// Depth of nested structures and unions, itself included.
    std::uint64_t levels{0};
    bool has_matrix{false};
    bool has_union{false};
    bool has_first_index{false};
    /// The structures and unions that its members are of, each once.
    std::vector<const DerivedType*> inner{};
};

/// The same facts about a variable.
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
    /// The type of a structure or union, or of an array's elements.
    const DerivedType* structure{nullptr};
};

/// The facts about a program's types; computes each once, when it is first requested.
class TypeFactsTable {
public:
    /// `program` must outlive this object.
    explicit TypeFactsTable(const ProgramTypes& program)
        : program_{&program}, facts_(program.program().types.size())
    {
    }

    [[nodiscard]] VariableFacts of(const TypeUse& use);
    /// Returns the folded names of the structures and unions that `top` consists of, itself
    /// included, that are not in `known`; stops once there are more than `room`. `top` may be null.
    [[nodiscard]] std::vector<std::string>
    new_definitions(const DerivedType* top, const std::unordered_set<std::string>& known,
                    std::uint64_t room);

private:
    [[nodiscard]] const TypeFacts& of_type(const DerivedType& type);
    [[nodiscard]] TypeFacts find_facts(const DerivedType& type);
    void add_member(TypeFacts& facts, const DerivedType& type, const TypeUse& use);

    const ProgramTypes* program_;
    /// Facts in the order of Program::types.
    std::vector<std::optional<TypeFacts>> facts_;
};

} // namespace busbar::controller::detail
