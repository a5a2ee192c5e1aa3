#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <pugixml.hpp>

#include <busbar/controller/plcopen_xml.hpp>

#include "controller/program/program_parts.hpp"

namespace busbar::controller::detail {

/// Parses a file of PLCopen XML or IEC 61131-10 into a Program. Each step gives false once there is
/// a problem.
class PlcopenReader {
public:
    /// All arguments must outlive this object.
    PlcopenReader(const SourceText& source, const DeclarationLimits& limits)
        : source_{&source}, limits_{&limits}
    {
    }

    /// Parses the document, whose memory counts for the parts.
    [[nodiscard]] Configured<void> open(ProgramParts& to);
    /// Adds everything to the pass.
    [[nodiscard]] Configured<void> read(ReadingPass& pass);

private:
    // plcopen_reader.cpp
    [[nodiscard]] bool parse(ProgramParts& to);
    [[nodiscard]] bool check_root(const pugi::xml_node& root);
    /// Reads all types, variables, tasks and instances of programs below the container.
    [[nodiscard]] bool read_container(const pugi::xml_node& container, std::size_t depth);
    [[nodiscard]] bool read_part(const pugi::xml_node& xml, std::size_t depth);
    /// Notes a unit of the <GlobalNamespace>, which may be the type of variables.
    [[nodiscard]] bool note_unit(const pugi::xml_node& xml);
    [[nodiscard]] bool read_task(const pugi::xml_node& xml);
    [[nodiscard]] bool read_interval(const pugi::xml_node& xml, ProgramTask& task);
    [[nodiscard]] bool read_instance(const pugi::xml_node& xml, const std::string& task);

    // plcopen_types.cpp
    [[nodiscard]] bool read_type(const pugi::xml_node& xml);
    [[nodiscard]] bool read_type_body(const pugi::xml_node& xml, DerivedType& type);
    /// Reads the <baseType> of an enumeration, if present.
    [[nodiscard]] bool read_base(const pugi::xml_node& xml, ElementaryType& base);
    /// Reads the elements of `xml` as the values of an enumeration.
    [[nodiscard]] bool read_values(const pugi::xml_node& xml, std::string_view element,
                                   DerivedType& type, ElementaryType base);
    [[nodiscard]] bool read_members(const pugi::xml_node& xml, DerivedType& type);
    [[nodiscard]] bool read_enumerators(const pugi::xml_node& xml, DerivedType& type);
    [[nodiscard]] bool read_enumerator(const pugi::xml_node& xml, DerivedType& type,
                                       ElementaryType base);
    /// Reads the type in the <type> or <baseType> of `xml`.
    [[nodiscard]] bool read_use(const pugi::xml_node& xml, std::string_view holder, TypeUse& use);
    [[nodiscard]] bool read_one_use(const pugi::xml_node& xml, TypeUse& use);
    /// Reads the name of a declared type, or of an elementary one that the schema lacks.
    [[nodiscard]] bool read_derived_name(const pugi::xml_node& xml, TypeUse& use);
    /// Reads a structure, union or enumeration without a name, which becomes a type that is named
    /// after the declaration that it is in: "Press.Mode.ENUM".
    [[nodiscard]] bool read_nameless(const pugi::xml_node& xml, TypeUse& use);
    /// Notes the structure that the type extends, as CODESYS has it in <addData>.
    [[nodiscard]] bool read_extends(const pugi::xml_node& xml, const DerivedType& type);
    [[nodiscard]] bool read_dimensions(const pugi::xml_node& xml, TypeUse& use);
    [[nodiscard]] bool read_subrange(const pugi::xml_node& xml, TypeUse& use);
    [[nodiscard]] bool read_bounds(const pugi::xml_node& xml, Bounds& bounds);

    // iec61131_10.cpp
    /// Reads a <DataTypeDecl> of IEC 61131-10.
    [[nodiscard]] bool read_declared_type(const pugi::xml_node& xml);
    [[nodiscard]] bool read_specification(const pugi::xml_node& xml, DerivedType& type);
    /// Reads a type that is written as in declarations.
    [[nodiscard]] bool read_type_name(const pugi::xml_node& xml, TypeUse& use);
    /// Reads the type in the <BaseType> and, if present, the range of values.
    [[nodiscard]] bool read_derived(const pugi::xml_node& xml, TypeUse& use);

    // plcopen_variables.cpp
    [[nodiscard]] bool read_variables(const pugi::xml_node& xml);
    [[nodiscard]] bool read_variable(const pugi::xml_node& xml, GlobalVariable variable);
    /// Returns the publish attribute of a variable that is left out, as far as it can be read.
    [[nodiscard]] static NetworkPublish publish_of_variable(const pugi::xml_node& xml,
                                                            NetworkPublish common);
    /// Notes a constant with the text of its value.
    [[nodiscard]] bool add_constant(const pugi::xml_node& xml, const GlobalVariable& variable);
    [[nodiscard]] bool read_publish(const pugi::xml_node& xml, NetworkPublish& publish);
    [[nodiscard]] bool read_flag(const pugi::xml_node& xml, const char* name, bool& flag);
    /// Reads the <initialValue>, if present.
    [[nodiscard]] bool read_initial(const pugi::xml_node& xml, InitialValue& initial);
    /// Reads the attribute or the <Address>, if present.
    [[nodiscard]] bool read_address(const pugi::xml_node& xml, std::string& address);
    /// Reads the single value in `holder`.
    [[nodiscard]] bool read_value(const pugi::xml_node& holder, InitialValue& value,
                                  std::size_t depth);
    [[nodiscard]] bool read_parts(const pugi::xml_node& xml, InitialValue& value, bool is_list,
                                  std::size_t depth);
    [[nodiscard]] bool read_documentation(const pugi::xml_node& xml, std::string& comment);

    // plcopen_text.cpp
    [[nodiscard]] bool read_name(const pugi::xml_node& xml, const char* attribute,
                                 std::string& name);
    /// Reads an integer from an attribute, which must be present, as an expression.
    [[nodiscard]] bool read_number(const pugi::xml_node& xml, const char* attribute,
                                   std::int64_t& number);
    [[nodiscard]] bool keep(const pugi::xml_node& xml, std::size_t bytes);
    [[nodiscard]] ProgramPlace place_of(const pugi::xml_node& xml) const;
    /// After a problem with a declaration: notes that it is left out. False if reading has to end.
    [[nodiscard]] bool leave_out(const pugi::xml_node& xml, LeftOut::Kind kind,
                                 NetworkPublish publish);
    /// Reports a problem; always returns false.
    bool fail(const pugi::xml_node& xml, std::string text);
    bool fail_at(std::size_t offset, std::string text);

    const SourceText* source_;
    const DeclarationLimits* limits_;
    ReadingPass* pass_{nullptr};
    bool leaves_out_{false};
    /// The name of the type or variable that is being read, with those of members.
    std::string path_{};
    /// Structures around the type that is being read.
    std::size_t depth_{0};
    pugi::xml_document document_{};
    std::optional<Problem> problem_{};
    ProgramPlace problem_place_{};
    bool is_exhausted_{false};
};

/// Adds a file of PLCopen XML or IEC 61131-10. The source must outlive the parts.
[[nodiscard]] Configured<void> add_plcopen(const SourceText& source,
                                           const DeclarationLimits& limits, ProgramParts& to);

/// Counts the memory of a parsed document for the parts; false if that is too much.
[[nodiscard]] bool take_document(std::string_view text, const DeclarationLimits& limits,
                                 ProgramParts& to);
/// Returns an upper bound of the memory that a parsed document takes, including its text. Each
/// bracket may begin an element followed by a text, each equals sign an attribute.
[[nodiscard]] std::size_t memory_of_document(std::string_view text);
/// Returns the element's name without its prefix.
[[nodiscard]] std::string_view local_name_of(const pugi::xml_node& xml);
/// True if the element has this name, ignoring its prefix and whether it begins with a capital, as
/// the names of IEC 61131-10 do.
[[nodiscard]] bool is_named(const pugi::xml_node& xml, std::string_view name);
/// Returns the first child element that is_named() so; null if there is none.
[[nodiscard]] pugi::xml_node child_of(const pugi::xml_node& xml, std::string_view name);
/// Returns what kind of specification an element of IEC 61131-10 is: its xsi:type without a prefix.
[[nodiscard]] std::string_view specification_of(const pugi::xml_node& xml);
[[nodiscard]] bool is_array_specification(const pugi::xml_node& xml);
/// Returns the first child that is an element.
[[nodiscard]] pugi::xml_node first_element_of(const pugi::xml_node& xml);
/// Writes an element's name as "<variable>".
[[nodiscard]] std::string tag_of(const pugi::xml_node& xml);

/// Adds the declarations in a file of TwinCAT: .TcGVL, .TcDUT, .TcPOU and .TcIO, a <TcPlcObject>
/// whose objects have a <Declaration> with a text. Problems have the places in the file. The source
/// must outlive the parts.
[[nodiscard]] Configured<void> add_twincat(const SourceText& source,
                                           const DeclarationLimits& limits, ProgramParts& to);

} // namespace busbar::controller::detail
