#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>

#include "declaration_cursor.hpp"

namespace busbar::controller::detail {

/// Reads declarations into a Program. Each step is false with a problem at the cursor.
class DeclarationParser {
public:
    explicit DeclarationParser(DeclarationCursor& cursor) : cursor_{&cursor} {}

    [[nodiscard]] bool read();
    [[nodiscard]] Program& program() { return program_; }

private:
    /// What stands behind VAR_GLOBAL, and before it.
    struct Block {
        NetworkPublish publish{NetworkPublish::Hidden};
        bool is_constant{false};
        bool is_retained{false};
        bool is_not_retained{false};
    };
    struct Name {
        std::string text;
        ProgramPlace place{};
    };

    // declaration_parser.cpp
    [[nodiscard]] bool read_block();
    /// Pragmas, as many as there are; the last about publishing counts.
    [[nodiscard]] bool read_pragmas(std::optional<NetworkPublish>& publish);
    /// "a, b, c"
    [[nodiscard]] bool read_names(std::vector<Name>& names, std::string_view what);
    /// `:=` and what is behind it, if there is one.
    [[nodiscard]] bool read_initial(InitialValue& initial);
    /// The `;`, then the comment of what it ends.
    [[nodiscard]] bool read_end(std::string& comment);
    [[nodiscard]] bool keep_comment(std::string& comment);

    // declaration_types.cpp
    [[nodiscard]] bool read_types();
    [[nodiscard]] bool read_type();
    [[nodiscard]] bool read_type_body(DerivedType& type);
    [[nodiscard]] bool read_members(DerivedType& type, std::string_view end_word);
    [[nodiscard]] bool read_member(DerivedType& type);

    // declaration_enumeration.cpp
    /// "A := 1, B)", of which the parenthesis is taken; of the base type if one stands before it.
    [[nodiscard]] bool read_enumerators(DerivedType& type, std::optional<ElementaryType> base);
    [[nodiscard]] bool read_enumerator(DerivedType& type, std::optional<ElementaryType> base);
    /// The base type behind the enumerators, if there is one.
    [[nodiscard]] bool read_base(const DerivedType& type);

    // declaration_use.cpp
    /// Of the type that is declared it can also be the enumeration `INT (A, B)`.
    [[nodiscard]] bool read_use(TypeUse& use, DerivedType* declared = nullptr);
    [[nodiscard]] bool read_bounds(TypeUse& use);
    [[nodiscard]] bool read_range(Bounds& bounds);
    [[nodiscard]] bool read_elementary(TypeUse& use, DerivedType* declared);
    [[nodiscard]] bool read_length(TypeUse& use);

    // declaration_variables.cpp
    [[nodiscard]] bool read_variables(NetworkPublish publish);
    [[nodiscard]] bool read_qualifiers(Block& block);
    [[nodiscard]] bool read_declaration(const Block& block);
    [[nodiscard]] bool read_address(const std::vector<Name>& names, std::string& address);
    [[nodiscard]] bool add_variables(std::vector<Name> names, const GlobalVariable& variable);

    // declaration_configuration.cpp
    [[nodiscard]] bool read_configuration();
    [[nodiscard]] bool read_resource();
    /// What stands in a configuration or resource; nothing of these: false without a problem.
    [[nodiscard]] bool read_resource_part(bool& is_part);
    [[nodiscard]] bool read_task();
    [[nodiscard]] bool read_task_setting(ProgramTask& task);
    [[nodiscard]] bool read_interval(ProgramTask& task);
    [[nodiscard]] bool read_instance();
    [[nodiscard]] bool skip_connections();

    DeclarationCursor* cursor_;
    Program program_{};
};

} // namespace busbar::controller::detail
