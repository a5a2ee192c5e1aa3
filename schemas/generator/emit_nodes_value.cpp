#include "node_values.hpp"

#include <charconv>
#include <cstdio>

#include <busbar/binary/codec.hpp>
#include <busbar/core/function_ref.hpp>
#include <core/base64.hpp>

namespace busbar::generator {

namespace {

using nodeset::Element;
using nodeset::Node;

/// Turns the XML form of values (Part 6, 5.3) into C++ values; remembers the first thing wrong.
class ValueReader {
public:
    using FindDataType = FunctionRef<const Node*(std::string_view)>;

    ValueReader(const nodeset::Document& document, const Hierarchy& hierarchy, FindDataType find)
        : document_{document}, hierarchy_{hierarchy}, find_data_type_{find}
    {
    }

    [[nodiscard]] const std::string& error() const { return error_; }
    [[nodiscard]] Variant variant(const Element& xml);

private:
    static constexpr unsigned max_depth = 32;

    void fail(const Element& xml, const std::string& expected)
    {
        if (error_.empty()) {
            error_ = std::to_string(xml.line) + ": found <" + xml.name + "> \"" + xml.text +
                     "\", expected " + expected;
        }
    }
    template <typename T>
    [[nodiscard]] T read_child(const Element& xml, std::string_view name)
    {
        T value{};
        if (const Element* const child = xml.child(name)) {
            read(*child, value);
        }
        return value;
    }
    template <typename T>
    requires(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) void read(const Element& xml,
                                                                            T& value)
    {
        const char* const end = xml.text.data() + xml.text.size();
        if (std::from_chars(xml.text.data(), end, value).ptr != end || xml.text.empty()) {
            fail(xml, "a number");
        }
    }
    void read(const Element& xml, bool& value)
    {
        value = xml.text == "true" || xml.text == "1";
        if (!value && xml.text != "false" && xml.text != "0") {
            fail(xml, "true or false");
        }
    }
    void read(const Element& xml, String& value)
    {
        value = xml.is_nil ? String{} : String{xml.text};
    }
    void read(const Element& xml, DateTime& value);
    void read(const Element& xml, Guid& value);
    void read(const Element& xml, ByteString& value);
    void read(const Element& xml, NodeId& value);
    void read(const Element& xml, ExpandedNodeId& value) { read(xml, value.node_id); }
    void read(const Element& xml, StatusCode& value)
    {
        value = StatusCode{read_child<std::uint32_t>(xml, "Code")};
    }
    void read(const Element& xml, QualifiedName& value)
    {
        value.namespace_index = read_child<std::uint16_t>(xml, "NamespaceIndex");
        value.name = read_child<String>(xml, "Name");
    }
    void read(const Element& xml, LocalizedText& value)
    {
        value.locale = read_child<String>(xml, "Locale");
        value.text = read_child<String>(xml, "Text");
    }
    void read(const Element& xml, ExtensionObject& value);
    void read(const Element& xml, Variant& value)
    {
        const Element* const inner = xml.child("Value");
        if (inner != nullptr && !inner->children.empty()) {
            value = variant(inner->children.front());
        }
    }
    void read(const Element& xml, XmlElement&) { fail(xml, "a type other than XmlElement"); }

    template <typename T>
    [[nodiscard]] Variant values(const Element& xml, bool is_list)
    {
        if (!is_list) {
            T value{};
            read(xml, value);
            if constexpr (std::is_same_v<T, Variant>) {
                return value;
            } else {
                return Variant{std::move(value)};
            }
        }
        Array<T> all;
        all.clear();
        for (const Element& child : xml.children) {
            read(child, all.emplace_back());
        }
        return Variant{std::move(all)};
    }
    [[nodiscard]] Variant of_type(const Element& xml, std::string_view name, bool is_list);
    void encode_field(binary::Writer& writer, const Element& xml, const nodeset::Field& field,
                      unsigned depth);
    void encode_scalar(binary::Writer& writer, const Element& xml, const NodeId& type,
                       unsigned depth);
    void encode_structure(binary::Writer& writer, const Element& xml, const Node& type,
                          unsigned depth);

    const nodeset::Document& document_;
    const Hierarchy& hierarchy_;
    FindDataType find_data_type_;
    std::string error_;
};

void ValueReader::read(const Element& xml, DateTime& value)
{
    int year = 0;
    int month = 0;
    int day = 0;
    int hour = 0;
    int minute = 0;
    int second = 0;
    if (std::sscanf(xml.text.c_str(), "%d-%d-%dT%d:%d:%d", &year, &month, &day, &hour, &minute,
                    &second) < 3) {
        fail(xml, "a time such as 2026-05-01T00:00:00Z");
        return;
    }
    using namespace std::chrono;
    const sys_days date{std::chrono::year{year} / month / day};
    const auto seconds =
        date.time_since_epoch() + hours{hour} + minutes{minute} + std::chrono::seconds{second};
    value = DateTime::from_unix_seconds(duration_cast<std::chrono::seconds>(seconds).count());
}

void ValueReader::read(const Element& xml, Guid& value)
{
    const Element* const text = xml.child("String");
    const auto guid = Guid::parse(text == nullptr ? xml.text : text->text);
    if (!guid) {
        fail(xml, "a Guid");
        return;
    }
    value = *guid;
}

void ValueReader::read(const Element& xml, ByteString& value)
{
    if (xml.is_nil) {
        return;
    }
    const auto bytes = detail::from_base64(xml.text);
    if (!bytes) {
        fail(xml, "base64");
        return;
    }
    value = ByteString{std::span{*bytes}};
}

void ValueReader::read(const Element& xml, NodeId& value)
{
    const Element* const text = xml.child("Identifier");
    if (text == nullptr || text->text.empty()) {
        return;
    }
    const auto id = NodeId::parse(text->text);
    if (!id) {
        fail(xml, "a NodeId");
        return;
    }
    value = *id;
}

void ValueReader::read(const Element& xml, ExtensionObject& value)
{
    const Element* const body = xml.child("Body");
    if (body == nullptr || body->children.empty()) {
        return;
    }
    // The TypeId is that of the XML encoding, which Busbar's schema leaves out.
    const Element& structure = body->children.front();
    const Node* const type = find_data_type_(structure.name);
    if (type == nullptr) {
        fail(structure, "the name of a structure");
        return;
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_structure(writer, structure, *type, 0);
    const auto bytes = sink.take(writer.written());
    value = ExtensionObject::from_binary(hierarchy_.binary_encoding(type->id),
                                         ByteString{std::span{bytes}});
}

Variant ValueReader::of_type(const Element& xml, std::string_view name, bool is_list)
{
    // clang-format off
    if (name == "Boolean") { return values<bool>(xml, is_list); }
    if (name == "SByte") { return values<std::int8_t>(xml, is_list); }
    if (name == "Byte") { return values<std::uint8_t>(xml, is_list); }
    if (name == "Int16") { return values<std::int16_t>(xml, is_list); }
    if (name == "UInt16") { return values<std::uint16_t>(xml, is_list); }
    if (name == "Int32") { return values<std::int32_t>(xml, is_list); }
    if (name == "UInt32") { return values<std::uint32_t>(xml, is_list); }
    if (name == "Int64") { return values<std::int64_t>(xml, is_list); }
    if (name == "UInt64") { return values<std::uint64_t>(xml, is_list); }
    if (name == "Float") { return values<float>(xml, is_list); }
    if (name == "Double") { return values<double>(xml, is_list); }
    if (name == "String") { return values<String>(xml, is_list); }
    if (name == "DateTime") { return values<DateTime>(xml, is_list); }
    if (name == "Guid") { return values<Guid>(xml, is_list); }
    if (name == "ByteString") { return values<ByteString>(xml, is_list); }
    if (name == "NodeId") { return values<NodeId>(xml, is_list); }
    if (name == "ExpandedNodeId") { return values<ExpandedNodeId>(xml, is_list); }
    if (name == "StatusCode") { return values<StatusCode>(xml, is_list); }
    if (name == "QualifiedName") { return values<QualifiedName>(xml, is_list); }
    if (name == "LocalizedText") { return values<LocalizedText>(xml, is_list); }
    if (name == "ExtensionObject") { return values<ExtensionObject>(xml, is_list); }
    if (name == "Variant") { return values<Variant>(xml, is_list); }
    // clang-format on
    fail(xml, "a built-in type");
    return {};
}

Variant ValueReader::variant(const Element& xml)
{
    constexpr std::string_view list = "ListOf";
    const std::string_view name = xml.name;
    const bool is_list = name.starts_with(list);
    return of_type(xml, is_list ? name.substr(list.size()) : name, is_list);
}

void ValueReader::encode_scalar(binary::Writer& writer, const Element& xml, const NodeId& type,
                                unsigned depth)
{
    const Kind kind = hierarchy_.kind(type);
    if (kind == Kind::Enumeration) {
        // "Name_3"
        const std::size_t digits = xml.text.find_last_of('_') + 1;
        encode(writer,
               static_cast<std::int32_t>(std::strtol(xml.text.c_str() + digits, nullptr, 10)));
        return;
    }
    const bool is_open = kind == Kind::Structure && hierarchy_.is_open_structure(type);
    const Node* const node = document_.find(type);
    if ((kind == Kind::Structure || kind == Kind::Union || kind == Kind::OptionSetStructure) &&
        !is_open) {
        if (node == nullptr || kind == Kind::Union) {
            fail(xml, "a structure that is no union");
        } else {
            encode_structure(writer, xml, *node, depth + 1);
        }
        return;
    }
    const auto built_in = static_cast<BuiltInType>(kind);
    const Variant value = of_type(xml, is_open ? "ExtensionObject" : busbar::name(built_in), false);
    // A Variant's one byte of type is not part of a field.
    if (built_in == BuiltInType::Variant) {
        encode(writer, value);
        return;
    }
    const auto bytes = binary::to_bytes(value);
    if (bytes && !bytes->empty()) {
        writer.bytes(std::span{*bytes}.subspan(1));
    }
}

void ValueReader::encode_field(binary::Writer& writer, const Element& xml,
                               const nodeset::Field& field, unsigned depth)
{
    static const Element absent{"", "", {}, 0, true};
    const Element* const found = xml.child(field.name);
    if (field.value_rank < 0) {
        const bool is_text_missing = found == nullptr || (found->is_nil && found->text.empty());
        if (!is_text_missing) {
            encode_scalar(writer, *found, field.data_type, depth);
            return;
        }
        Element zero = absent;
        const Kind kind = hierarchy_.kind(field.data_type);
        if (kind >= Kind{1} && kind <= Kind{11}) {
            zero.text = "0";
        } else if (kind == static_cast<Kind>(BuiltInType::DateTime)) {
            zero.text = "1601-01-01T00:00:00Z";
        }
        encode_scalar(writer, zero, field.data_type, depth);
        return;
    }
    if (found == nullptr || found->is_nil) {
        writer.number(std::int32_t{-1});
        return;
    }
    writer.length(found->children.size());
    for (const Element& child : found->children) {
        encode_scalar(writer, child, field.data_type, depth);
    }
}

void ValueReader::encode_structure(binary::Writer& writer, const Element& xml, const Node& type,
                                   unsigned depth)
{
    if (depth > max_depth) {
        fail(xml, "structures less deep");
        return;
    }
    if (const Node* const base = hierarchy_.supertype(type.id);
        base != nullptr && !hierarchy_.is_open_structure(base->id)) {
        encode_structure(writer, xml, *base, depth + 1);
    }
    if (!type.definition) {
        return;
    }
    for (const nodeset::Field& field : type.definition->fields) {
        if (field.is_optional || field.value_rank > 1) {
            fail(xml, "a structure without optional fields and matrices");
            return;
        }
        encode_field(writer, xml, field, depth);
    }
}

} // namespace

NodeValues::NodeValues(const nodeset::Document& document, const Hierarchy& hierarchy)
    : document_{document}, hierarchy_{hierarchy}
{
    for (const Node& node : document.nodes()) {
        if (node.node_class == nodeset::NodeClass::DataType) {
            data_types_[node.browse_name] = &node;
        }
    }
}

const Node* NodeValues::data_type(std::string_view name) const
{
    const auto found = data_types_.find(std::string{name});
    return found == data_types_.end() ? nullptr : found->second;
}

tl::expected<std::string, Failure> NodeValues::value(const Node& node) const
{
    const auto find = [this](std::string_view name) { return data_type(name); };
    ValueReader reader{document_, hierarchy_, find};
    const Element* const root = node.value ? &*node.value : nullptr;
    // The reader of documents may keep the <Value> itself or what is in it.
    const Element* const xml = root != nullptr && root->name == "Value" && !root->children.empty()
                                   ? &root->children.front()
                                   : root;
    if (xml == nullptr || xml->name == "Value") {
        return std::string{};
    }
    const auto bytes = binary::to_bytes(reader.variant(*xml));
    if (!reader.error().empty() || !bytes) {
        return tl::make_unexpected(document_.files()[node.file] + ":" +
                                   (bytes ? reader.error() : std::string{"cannot be encoded"}));
    }
    return std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

} // namespace busbar::generator
