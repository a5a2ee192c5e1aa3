#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>

#include "declaration_cursor.hpp"
#include "program_parts.hpp"

namespace busbar::controller::detail {

/// Parses declarations into a Program. Each step gives false after reporting a problem at the
/// cursor.
class DeclarationParser {
public:
    /// Adds what it reads to the pass. Both must outlive this object.
    DeclarationParser(DeclarationCursor& cursor, ReadingPass& pass)
        : cursor_{&cursor}, pass_{&pass}, leaves_out_{pass.unserved == Unserved::LeaveOut}
    {
    }

    [[nodiscard]] bool read();
    /// Parses a type.
    [[nodiscard]] bool read_type_use(TypeUse& use) { return read_use(use); }

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
    /// Parses a structure, union or enumeration without a name, which becomes a type that is named
    /// after the declaration that it is in: "Press.Mode.ENUM".
    [[nodiscard]] bool read_nameless(TypeUse& use);
    [[nodiscard]] bool is_at_nameless() const;

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
    /// Notes the names of `declaring_` as constants whose `:=` begins at this offset.
    [[nodiscard]] bool add_constants(const TypeUse& type, std::size_t initial);
    [[nodiscard]] bool read_address(std::string& address);
    [[nodiscard]] bool add_variables(const GlobalVariable& variable);

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

    // declaration_recovery.cpp
    /// After a problem: notes the declaration of `declaring_`, or a part, as left out and skips it.
    /// False if reading has to end.
    [[nodiscard]] bool leave_out(LeftOut::Kind kind);
    [[nodiscard]] bool note(LeftOut::Kind kind, std::string name, const ProgramPlace& place,
                            const std::string& text);
    /// Skips the rest of a declaration within `depth_` structures: up to and including its
    /// semicolon, or up to a word that begins or ends a block.
    void skip_declaration();
    void skip_to_block();
    /// True at a word that begins a block, or at the end: the block before it has no end.
    [[nodiscard]] bool is_after_block() const;
    /// True where the block that `last` ends has no end: also at the end of another block.
    [[nodiscard]] bool is_out_of_block(std::string_view last) const;
    /// Parses what only a whole program has: units, namespaces, variables that are not global.
    /// False without a problem if there is none.
    [[nodiscard]] bool read_beside(bool& is_part);
    /// Skips a unit whose first word is taken: up to its last word, or up to the next block.
    [[nodiscard]] bool skip_unit(std::string_view last, std::string_view words);
    /// Skips variables of another kind, whose first word is taken.
    [[nodiscard]] bool skip_variables();
    [[nodiscard]] bool enter_namespace();
    void skip_semicolons();
    /// Parses the name of a type, with those of its namespaces.
    [[nodiscard]] bool read_qualified(TypeUse& use);

    // declaration_siemens.cpp
    /// What the header of a block says.
    struct BlockHeader {
        bool is_hidden{false};
        bool is_retained{false};
        bool is_read_only{false};
    };
    [[nodiscard]] bool skip_header(BlockHeader& header);
    /// Parses a data block, whose first word is taken, as a variable.
    [[nodiscard]] bool read_data_block();
    [[nodiscard]] bool read_block_type(TypeUse& use);
    /// Parses the assignments after BEGIN, and END_DATA_BLOCK.
    [[nodiscard]] bool read_start_values(InitialValue& initial);
    /// Skips the rest of the assignment to a part of a member, which keeps the value of its type.
    /// `place` is that of the member.
    [[nodiscard]] bool skip_start_value(const ProgramPlace& place);
    /// Skips the rest of a data block after a problem.
    [[nodiscard]] bool skip_data_block();

    [[nodiscard]] Program& program() { return pass_->program; }

    DeclarationCursor* cursor_;
    ReadingPass* pass_;
    bool leaves_out_;
    /// The names of the declaration that is being read, and whether to publish it.
    std::vector<Name> declaring_{};
    NetworkPublish declaring_publish_{};
    /// The place of the last problem; a second one there skips a token.
    std::size_t last_problem_{SIZE_MAX};
    /// Structures and unions around the current token.
    std::size_t depth_{0};
    /// The name of the type or variable that is being parsed, with those of members.
    std::string path_{};
};

/// Reads a type as it stands in declarations. Gives false after reporting a problem at the cursor.
[[nodiscard]] BUSBAR_API bool read_type_use(DeclarationCursor& cursor, ReadingPass& pass,
                                            TypeUse& use);

} // namespace busbar::controller::detail
