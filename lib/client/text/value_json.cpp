#include <busbar/client/value_json.hpp>

#include <charconv>
#include <cmath>

#include "core/base64.hpp"
#include "core/json_writer.hpp"
#include "core/visit_built_in.hpp"

namespace busbar::client {

namespace {

using binary::DynamicArray;
using binary::DynamicValue;

class ValueWriter {
public:
    explicit ValueWriter(const JsonOptions& options) : options_{options} {}

    [[nodiscard]] std::string take() { return json_.take(); }

    void write(const Variant& value)
    {
        if (value.is_null()) {
            return add("null");
        }
        if (!options_.with_types) {
            return content(value);
        }
        json_.begin_object();
        variant_members(value);
        json_.end_object();
    }
    void write(const DataValue& value)
    {
        json_.begin_object();
        if (options_.with_types && !value.value.is_null()) {
            variant_members(value.value);
        } else if (!options_.with_types) {
            member("Value");
            content(value.value);
        }
        if (value.status != status::Good) {
            member("Status");
            write(value.status);
        }
        time("SourceTimestamp", value.source_timestamp);
        time("ServerTimestamp", value.server_timestamp);
        json_.end_object();
    }
    void write(const DynamicValue& value)
    {
        json_.begin_object();
        fields(value);
        json_.end_object();
    }

private:
    void add(std::string_view word) { json_.word(word); }
    void quoted(std::string_view text) { json_.string(text); }
    void member(std::string_view name) { json_.name(name); }
    void time(std::string_view name, DateTime value)
    {
        if (!value.is_null()) {
            member(name);
            write(value);
        }
    }

    /// Calls `print` one level deeper, or adds null past the limit.
    template <typename Print>
    void nested(Print print)
    {
        if (depth_ == options_.max_depth) {
            return add("null");
        }
        ++depth_;
        print();
        --depth_;
    }
    template <typename T, typename Print>
    void list(std::span<const T> values, Print print)
    {
        json_.begin_list();
        for (std::size_t i = 0; i < values.size(); ++i) {
            nested([&] { print(values[i]); });
        }
        json_.end_list();
    }
    /// Prints lists of lists, by the remaining dimensions.
    template <typename T, typename Print>
    void matrix(std::span<const T> values, std::span<const std::uint32_t> dimensions, Print print)
    {
        if (dimensions.size() < 2 || dimensions.front() == 0) {
            return list(values, print);
        }
        const std::size_t size = values.size() / dimensions.front();
        json_.begin_list();
        for (std::size_t i = 0; i < dimensions.front(); ++i) {
            matrix(values.subspan(i * size, size), dimensions.subspan(1), print);
        }
        json_.end_list();
    }

    void variant_members(const Variant& value)
    {
        member("UaType");
        write(static_cast<unsigned>(value.type()));
        member("Value");
        content(value, true);
        if (value.is_matrix()) {
            member("Dimensions");
            list(value.dimensions(), [this](std::uint32_t size) { write(size); });
        }
    }
    /// Prints a matrix as a list, with its dimensions beside it, or as lists of lists.
    void content(const Variant& value, bool is_flat = false)
    {
        if (value.is_null()) {
            return add("null");
        }
        busbar::detail::visit_built_in(value.type(), [&](auto tag) {
            using T = typename decltype(tag)::type;
            if (const Array<T>* const values = value.array_if<T>()) {
                const auto print = [this](const T& element) { write(element); };
                if (values->is_null()) {
                    add("null");
                } else if (is_flat || !value.is_matrix()) {
                    list(values->span(), print);
                } else {
                    matrix(values->span(), value.dimensions(), print);
                }
            } else if constexpr (!std::is_same_v<T, Variant>) {
                nested([&] { write(*value.get_if<T>()); });
            }
        });
    }
    void fields(const DynamicValue& value)
    {
        for (std::size_t i = 0; i < value.type().fields.size(); ++i) {
            if (value.has(i)) {
                member(value.type().fields[i].name);
                nested([&] { field(value, i); });
            }
        }
    }
    void field(const DynamicValue& value, std::size_t index)
    {
        if (const Variant* const simple = value.value(index)) {
            // Only a field of any type needs to name the type.
            const bool is_open = value.type().fields[index].built_in == BuiltInType::Variant;
            is_open ? write(*simple) : content(*simple);
        } else if (const DynamicValue* const part = value.structure(index)) {
            write(*part);
        } else if (const DynamicArray* const parts = value.structures(index)) {
            if (parts->values.is_null()) {
                return add("null");
            }
            matrix(parts->values.span(), parts->dimensions.span(),
                   [this](const DynamicValue& element) { write(element); });
        }
    }

    void write(bool value) { add(value ? "true" : "false"); }
    template <typename T>
    requires std::is_arithmetic_v<T>
    void write(T value)
    {
        if constexpr (std::is_floating_point_v<T>) {
            if (!std::isfinite(value)) {
                return add(std::isnan(value) ? "\"NaN\""
                                             : (value > 0 ? "\"Infinity\"" : "\"-Infinity\""));
            }
        }
        char digits[32];
        const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
        const std::string_view number{digits, static_cast<std::size_t>(end - digits)};
        // Many readers read numbers of JSON as Doubles, which cannot hold 64 bits.
        constexpr bool is_long = std::is_integral_v<T> && sizeof(T) == 8;
        is_long ? quoted(number) : add(number);
    }
    void write(const String& value) { value.is_null() ? add("null") : quoted(value.view()); }
    void write(const ByteString& value)
    {
        value.is_null() ? add("null") : quoted(busbar::detail::to_base64(value.span()));
    }
    void write(DateTime value) { quoted(to_string(value)); }
    void write(const Guid& value) { quoted(to_string(value)); }
    void write(const NodeId& value) { quoted(to_string(value)); }
    void write(const ExpandedNodeId& value) { quoted(to_string(value)); }
    void write(const QualifiedName& value) { quoted(to_string(value)); }
    void write(StatusCode value)
    {
        json_.begin_object();
        member("Code");
        write(value.value());
        const std::string_view symbol = name(value);
        if (!symbol.empty()) {
            member("Symbol");
            quoted(symbol);
        }
        json_.end_object();
    }
    void write(const LocalizedText& value)
    {
        json_.begin_object();
        if (!value.locale.empty()) {
            member("Locale");
            write(value.locale);
        }
        member("Text");
        write(value.text);
        json_.end_object();
    }
    void write(const ExtensionObject& value)
    {
        if (value.is_null()) {
            return add("null");
        }
        if (options_.types != nullptr) {
            if (const auto known = binary::decode_dynamic(value, *options_.types)) {
                json_.begin_object();
                member("UaTypeId");
                write(known->type().id);
                fields(*known);
                return json_.end_object();
            }
        }
        encoded(value);
    }
    void encoded(const ExtensionObject& value)
    {
        json_.begin_object();
        member("UaTypeId");
        write(value.encoding_id());
        if (value.body() == ExtensionObject::Body::Xml) {
            body_member(2);
            write(value.xml());
        } else if (value.body() != ExtensionObject::Body::None) {
            body_member(1);
            write(body_of(value));
        }
        json_.end_object();
    }
    void body_member(unsigned encoding)
    {
        member("UaEncoding");
        write(encoding);
        member("UaBody");
    }
    [[nodiscard]] static ByteString body_of(const ExtensionObject& value)
    {
        if (value.body() != ExtensionObject::Body::Object) {
            return value.binary();
        }
        binary::VectorSink sink;
        binary::Writer writer{sink};
        value.type()->encode(writer, value.object());
        return ByteString{sink.take(writer.written())};
    }
    void write(const DiagnosticInfo& value)
    {
        json_.begin_object();
        if (value.additional_info) {
            member("AdditionalInfo");
            write(*value.additional_info);
        }
        json_.end_object();
    }

    JsonOptions options_;
    busbar::detail::JsonWriter json_;
    std::size_t depth_{0};
};

template <typename T>
std::string json_of(const T& value, const JsonOptions& options)
{
    ValueWriter writer{options};
    writer.write(value);
    return writer.take();
}

} // namespace

std::string to_json(const Variant& value, const JsonOptions& options)
{
    return json_of(value, options);
}

std::string to_json(const DataValue& value, const JsonOptions& options)
{
    return json_of(value, options);
}

std::string to_json(const DynamicValue& value, const JsonOptions& options)
{
    return json_of(value, options);
}

} // namespace busbar::client
