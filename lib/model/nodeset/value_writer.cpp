#include "value_writer.hpp"

#include <core/base64.hpp>

#include "built_in_visit.hpp"
#include "xml_text.hpp"

namespace busbar::nodeset {

std::uint16_t FileNamespaces::operator()(std::uint16_t index)
{
    const auto [at, is_new] = local_.try_emplace(index, static_cast<std::uint16_t>(used_.size()));
    if (is_new) {
        used_.push_back(index);
    }
    return at->second;
}

NodeId FileNamespaces::operator()(NodeId id)
{
    id.set_namespace_index((*this)(id.namespace_index()));
    return id;
}

void ValueWriter::variant(const Variant& value)
{
    if (value.is_matrix()) {
        matrix(value);
        return;
    }
    visit_built_in(value.type(), [&]<typename T>(std::type_identity<T>) {
        const std::string name{busbar::name(value.type())};
        if (const auto* const values = value.array_if<T>()) {
            list("ListOf" + name, *values);
        }
        if constexpr (!std::is_same_v<T, Variant>) {
            if (const auto* const scalar = value.get_if<T>()) {
                element(name, *scalar);
            }
        }
    });
}

void ValueWriter::say_nil()
{
    out_.attribute("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance");
    out_.attribute("xsi:nil", "true");
}

template <typename T>
void ValueWriter::list(std::string_view name, const Array<T>& values)
{
    out_.begin(name);
    if (values.is_null()) {
        say_nil();
    }
    for (const T& value : values) {
        element(busbar::name(built_in_type_of<T>), value);
    }
    out_.end();
}

void ValueWriter::matrix(const Variant& value)
{
    out_.begin("Matrix");
    out_.begin("Dimensions");
    for (const std::uint32_t dimension : value.dimensions()) {
        element("UInt32", dimension);
    }
    out_.end();
    out_.begin("Elements");
    visit_built_in(value.type(), [&]<typename T>(std::type_identity<T>) {
        if (const auto* const values = value.array_if<T>()) {
            for (const T& entry : *values) {
                element(busbar::name(value.type()), entry);
            }
        }
    });
    out_.end();
    out_.end();
}

void ValueWriter::contents(const XmlElement& value)
{
    out_.xml(value.view());
}

void ValueWriter::contents(const DateTime& value)
{
    out_.text(date_time_text(value));
}

void ValueWriter::contents(const ByteString& value)
{
    out_.text(detail::to_base64(value.span()));
}

void ValueWriter::contents(const NodeId& value)
{
    out_.element("Identifier", to_string(namespaces_(value)));
}

void ValueWriter::contents(const ExpandedNodeId& value)
{
    ExpandedNodeId local = value;
    if (value.is_local()) {
        local.node_id = namespaces_(value.node_id);
    }
    out_.element("Identifier", to_string(local));
}

void ValueWriter::contents(const StatusCode& value)
{
    out_.element("Code", std::to_string(value.value()));
}

void ValueWriter::contents(const QualifiedName& value)
{
    out_.element("NamespaceIndex", std::to_string(namespaces_(value.namespace_index)));
    if (!value.name.is_null()) {
        element("Name", value.name);
    }
}

void ValueWriter::contents(const busbar::LocalizedText& value)
{
    if (!value.locale.is_null()) {
        element("Locale", value.locale);
    }
    if (!value.text.is_null()) {
        element("Text", value.text);
    }
}

void ValueWriter::contents(const DataValue& value)
{
    contents(value.value);
    element("StatusCode", value.status);
    element("SourceTimestamp", value.source_timestamp);
    element("SourcePicoseconds", value.source_picoseconds);
    element("ServerTimestamp", value.server_timestamp);
    element("ServerPicoseconds", value.server_picoseconds);
}

void ValueWriter::contents(const Variant& value)
{
    constexpr unsigned max_depth = 32;
    if (value.is_null() || depth_ == max_depth) {
        return;
    }
    ++depth_;
    out_.begin("Value");
    variant(value);
    out_.end();
    --depth_;
}

void ValueWriter::contents(const ExtensionObject& value)
{
    if (!value.is_null()) {
        body(value);
    }
}

} // namespace busbar::nodeset
