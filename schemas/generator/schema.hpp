#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/core/expected.hpp>

#include <model/nodeset/document.hpp>

#include "options.hpp"

namespace busbar::generator {

struct Type;

/// The type of a field in C++ and on the wire.
struct FieldType {
    /// The type of one element, qualified as the generated namespace needs it.
    std::string cpp;
    std::size_t min_wire_size{1};
    /// Not null: the structure is one of this run and stands in place.
    const Type* structure{nullptr};
};

struct StructureField {
    std::string name;
    std::string schema_name;
    FieldType type;
    /// -1 scalar, 1 array, 2 and more a matrix.
    std::int32_t value_rank{-1};
    bool is_optional{false};
};

struct Enumerator {
    std::string name;
    std::int64_t value{0};
};

/// A DataType that becomes a C++ type.
struct Type {
    enum class Kind { Structure, Union, Enumeration, OptionSet };

    const nodeset::Node* node{nullptr};
    Kind kind{Kind::Structure};
    std::string name;
    /// All fields in wire order: those of the supertypes first.
    std::vector<StructureField> fields;
    /// Values of an enumeration, or bits of an option set, which may be a structure.
    std::vector<Enumerator> enumerators;
    /// "std::int32_t", or the option set's unsigned type.
    std::string underlying;
    /// Of Default Binary; null when there is none.
    NodeId encoding_id;
    /// The file it is written to, without suffix.
    std::string group;
    std::size_t min_wire_size{0};
    /// True if it may contain itself, through arrays.
    bool is_recursive{false};

    [[nodiscard]] bool is_structure() const
    {
        return kind == Kind::Structure || kind == Kind::Union;
    }
};

/// A service's request (Part 4, 7.32): it begins with a RequestHeader.
[[nodiscard]] inline bool is_request(const Type& type)
{
    return type.kind == Type::Kind::Structure && !type.fields.empty() &&
           type.fields.front().type.cpp == "RequestHeader";
}

/// The types of one namespace, ready to be written.
struct Schema {
    std::string namespace_uri;
    std::uint16_t namespace_index{0};
    /// The prefix of Busbar's names: "" or "busbar::".
    std::string prefix;
    std::deque<Type> types;
    /// The groups, each with its structures in an order in which C++ can declare them.
    struct Group {
        std::string name;
        std::vector<const Type*> structures;
        std::vector<std::string> includes;
    };
    std::vector<Group> groups;
    /// Include paths of other namespaces' types.
    std::vector<std::string> foreign_includes;
};

[[nodiscard]] Expected<Schema, Failure> make_schema(const nodeset::Document& document,
                                                    const Options& options);

/// Sorts the structures into files and each file's structures into an order of declaration.
[[nodiscard]] Expected<void, Failure> lay_out(Schema& schema, const nodeset::Document& document,
                                              const Options& options);

/// "file.xml:17: "
[[nodiscard]] std::string place(const nodeset::Document& document, const nodeset::Node& node,
                                std::uint32_t line);

} // namespace busbar::generator
