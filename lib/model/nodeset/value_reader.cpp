#include "value_reader.hpp"

#include <algorithm>

#include <busbar/core/text_forms.hpp>
#include <core/base64.hpp>

#include "built_in_visit.hpp"
#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

std::string without_blanks(std::string_view text)
{
    std::string result;
    std::copy_if(text.begin(), text.end(), std::back_inserter(result),
                 [](char c) { return c != ' ' && c != '\t' && c != '\r' && c != '\n'; });
    return result;
}

} // namespace

void XmlValueReader::fail(const Element& xml, const std::string& expected)
{
    if (error_.empty()) {
        error_ = "found <" + printable(xml.name, 80) + "> " + quoted(xml.text) + ", expected " +
                 expected;
        error_line_ = xml.line;
    }
}

std::uint16_t XmlValueReader::mapped(const Element& xml, std::uint16_t namespace_index)
{
    if (namespace_index < namespaces_.size()) {
        return namespaces_[namespace_index];
    }
    fail(xml,
         "a namespace index of the file's <NamespaceUris>, not " + std::to_string(namespace_index));
    return 0;
}

template <typename T>
requires(std::is_arithmetic_v<T> &&
         !std::is_same_v<T, bool>) void XmlValueReader::read(const Element& xml, T& value, unsigned)
{
    std::string_view text = trimmed(xml.text);
    text.remove_prefix(text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
    if (!to_number(text, value)) {
        fail(xml, "a number in the range of its type");
    }
}

template void XmlValueReader::read(const Element&, std::int32_t&, unsigned);
template void XmlValueReader::read(const Element&, std::uint32_t&, unsigned);

void XmlValueReader::read(const Element& xml, bool& value, unsigned)
{
    if (!to_bool(trimmed(xml.text), value)) {
        fail(xml, "true or false");
    }
}

void XmlValueReader::read(const Element& xml, String& value, unsigned)
{
    value = xml.is_nil ? String{} : String{xml.text};
}

void XmlValueReader::read(const Element& xml, XmlElement& value, unsigned)
{
    value = xml.is_nil ? XmlElement{} : XmlElement{String{xml.raw}};
}

void XmlValueReader::read(const Element& xml, DateTime& value, unsigned)
{
    if (const auto time = parse_date_time(trimmed(xml.text))) {
        value = *time;
    } else {
        fail(xml, "a time such as 2026-05-01T00:00:00Z");
    }
}

void XmlValueReader::read(const Element& xml, Guid& value, unsigned)
{
    const Element* const text = xml.child("String");
    const auto guid = Guid::parse(trimmed(text == nullptr ? xml.text : text->text));
    if (!guid) {
        fail(xml, "a Guid");
        return;
    }
    value = *guid;
}

void XmlValueReader::read(const Element& xml, ByteString& value, unsigned)
{
    if (xml.is_nil) {
        return;
    }
    const auto bytes = detail::from_base64(without_blanks(xml.text));
    if (!bytes) {
        fail(xml, "base64");
        return;
    }
    value = ByteString{std::span{*bytes}};
}

void XmlValueReader::read(const Element& xml, NodeId& value, unsigned)
{
    const Element* const identifier = xml.child("Identifier");
    if (identifier == nullptr || trimmed(identifier->text).empty()) {
        return;
    }
    const std::string_view text = trimmed(identifier->text);
    auto id = NodeId::parse(text);
    if (!id && published_ != nullptr) {
        const auto known = published_->find(std::string{text});
        if (known != published_->end()) {
            named_ = named_ == nullptr ? identifier : named_;
            value = known->second;
            return;
        }
    }
    if (!id) {
        fail(*identifier, "a NodeId");
        return;
    }
    id->set_namespace_index(mapped(*identifier, id->namespace_index()));
    value = std::move(*id);
}

/// "svr=1;nsu=urn:x;i=5" (Part 6, 5.3.1.11); a namespace URI stays one.
void XmlValueReader::read(const Element& xml, ExpandedNodeId& value, unsigned)
{
    const Element* const identifier = xml.child("Identifier");
    if (identifier == nullptr || trimmed(identifier->text).empty()) {
        return;
    }
    const std::string_view text = trimmed(identifier->text);
    auto id = parse_expanded_node_id(text);
    if (!id) {
        fail(*identifier, "an ExpandedNodeId");
        return;
    }
    value = std::move(*id);
    // The namespace table of another server is not the file's.
    if (value.server_index == 0 && value.namespace_uri.is_null()) {
        value.node_id.set_namespace_index(mapped(*identifier, value.node_id.namespace_index()));
    }
}

void XmlValueReader::read(const Element& xml, StatusCode& value, unsigned depth)
{
    value = StatusCode{read_child<std::uint32_t>(xml, "Code", depth)};
}

void XmlValueReader::read(const Element& xml, QualifiedName& value, unsigned depth)
{
    value.namespace_index = mapped(xml, read_child<std::uint16_t>(xml, "NamespaceIndex", depth));
    value.name = read_child<String>(xml, "Name", depth);
}

void XmlValueReader::read(const Element& xml, busbar::LocalizedText& value, unsigned depth)
{
    value.locale = read_child<String>(xml, "Locale", depth);
    value.text = read_child<String>(xml, "Text", depth);
}

void XmlValueReader::read(const Element& xml, DataValue& value, unsigned depth)
{
    read(xml, value.value, depth);
    value.status = read_child<StatusCode>(xml, "StatusCode", depth);
    value.source_timestamp = read_child<DateTime>(xml, "SourceTimestamp", depth);
    value.source_picoseconds = read_child<std::uint16_t>(xml, "SourcePicoseconds", depth);
    value.server_timestamp = read_child<DateTime>(xml, "ServerTimestamp", depth);
    value.server_picoseconds = read_child<std::uint16_t>(xml, "ServerPicoseconds", depth);
}

void XmlValueReader::read(const Element& xml, Variant& value, unsigned depth)
{
    const Element* const inner = xml.child("Value");
    if (inner != nullptr && !inner->children.empty()) {
        value = variant(inner->children.front(), depth + 1);
    }
}

template <typename T>
Variant XmlValueReader::values(const Element& xml, bool is_list, unsigned depth)
{
    if (!is_list) {
        T value{};
        read(xml, value, depth);
        if constexpr (std::is_same_v<T, Variant>) {
            return value;
        } else {
            return Variant{std::move(value)};
        }
    }
    Array<T> all;
    if (!xml.says_nil) {
        all.clear();
    }
    for (const Element& child : xml.children) {
        read(child, all.emplace_back(), depth);
    }
    return Variant{std::move(all)};
}

Variant XmlValueReader::of_type(const Element& xml, std::string_view name, bool is_list,
                                unsigned depth)
{
    for (std::uint8_t i = 1; i < static_cast<std::uint8_t>(BuiltInType::DiagnosticInfo); ++i) {
        if (name == busbar::name(BuiltInType{i})) {
            return visit_built_in(BuiltInType{i}, [&]<typename T>(std::type_identity<T>) {
                return values<T>(xml, is_list, depth);
            });
        }
    }
    fail(xml, "a built-in type");
    return {};
}

Variant XmlValueReader::variant(const Element& xml, unsigned depth)
{
    if (depth > max_depth) {
        fail(xml, "values less deep");
        return {};
    }
    constexpr std::string_view list = "ListOf";
    const std::string_view name = xml.name;
    if (name == "Matrix") {
        return matrix(xml, depth);
    }
    if (name == "Null") {
        return {};
    }
    const bool is_list = name.starts_with(list);
    return of_type(xml, is_list ? name.substr(list.size()) : name, is_list, depth);
}

/// <Dimensions> and <Elements> (Part 6, 5.3.1.17).
Variant XmlValueReader::matrix(const Element& xml, unsigned depth)
{
    const Element* const sizes = xml.child("Dimensions");
    const Element* const elements = xml.child("Elements");
    if (sizes == nullptr || elements == nullptr || elements->children.empty()) {
        fail(xml, "<Dimensions> and <Elements>");
        return {};
    }
    Array<std::uint32_t> dimensions;
    std::uint64_t count = 1;
    for (const Element& size : sizes->children) {
        read(size, dimensions.emplace_back(), depth);
        count *= *(dimensions.end() - 1);
        count = std::min<std::uint64_t>(count, UINT32_MAX);
    }
    if (dimensions.size() < 2 || count != elements->children.size()) {
        fail(xml, "as many <Elements> as the two or more <Dimensions> say");
        return {};
    }
    const Variant list = of_type(*elements, elements->children.front().name, true, depth);
    return visit_built_in(list.type(), [&]<typename T>(std::type_identity<T>) {
        const auto* const values = list.array_if<T>();
        return values == nullptr ? Variant{} : Variant::matrix(*values, dimensions);
    });
}

} // namespace busbar::nodeset
