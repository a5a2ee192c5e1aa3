#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>

#include "declaration_cursor.hpp"

namespace busbar::controller::detail {

/// Parses declarations into a Program. Each step gives false after reporting a problem at the
/// cursor.
class DeclarationParser {
public:
    explicit DeclarationParser(DeclarationCursor& cursor) : cursor_{&cursor} {}

    [[nodiscard]] bool read();
    [[nodiscard]] Program& program() { return program_; }

private:
    /// The attributes of a block of variables, written before and after VAR_GLOBAL.
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
    /// Parses any number of pragmas; the last one about publishing wins.
    [[nodiscard]] bool read_pragmas(std::optional<NetworkPublish>& publish);
    /// Parses a list "a, b, c".
    [[nodiscard]] bool read_names(std::vector<Name>& names, std::string_view what);
    /// Parses `:=` and the value after it, if present.
    [[nodiscard]] bool read_initial(InitialValue& initial);
    /// Parses the `;` and then the comment on the statement that it ends.
    [[nodiscard]] bool read_end(std::string& comment);
    [[nodiscard]] bool keep_comment(std::string& comment);

    // declaration_types.cpp
    [[nodiscard]] bool read_types();
    [[nodiscard]] bool read_type();
    [[nodiscard]] bool read_type_body(DerivedType& type);
    [[nodiscard]] bool read_members(DerivedType& type, std::string_view end_word);
    [[nodiscard]] bool read_member(DerivedType& type);

    // declaration_enumeration.cpp
    /// Parses enumerators such as "A := 1, B)", whose opening parenthesis is taken; `base` is the
    /// type named before it, if any.
    [[nodiscard]] bool read_enumerators(DerivedType& type, std::optional<ElementaryType> base);
    [[nodiscard]] bool read_enumerator(DerivedType& type, std::optional<ElementaryType> base);
    /// Parses the base type after the enumerators, if present.
    [[nodiscard]] bool read_base(const DerivedType& type);

    // declaration_use.cpp
    /// Parses a type; if it is for the declaration of `declared`, it may be an enumeration `INT (A,
    /// B)`.
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
    /// Parses one part of a configuration or resource; false without a problem if there is none.
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
