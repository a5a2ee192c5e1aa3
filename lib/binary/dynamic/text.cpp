#include <busbar/binary/dynamic_value.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>

#include <busbar/core/types.hpp>

#include "core/visit_built_in.hpp"
#include "iec_type.hpp"

namespace busbar::binary {

namespace {

/// Prints values into a string that stops growing at its limit.
class TextWriter {
public:
    TextWriter(const TextLimits& limits, const DynamicTypes* types) : limits_{limits}, types_{types}
    {
    }

    [[nodiscard]] std::string take() { return std::move(text_); }

    void structure(const DynamicValue& value)
    {
        const DynamicType& type = value.type();
        add(printable(type.name, limits_.max_string));
        add(" {");
        bool is_first = true;
        for (std::size_t i = 0; i < type.fields.size() && enter(); ++i) {
            if (value.has(i)) {
                add(is_first ? "" : ", ");
                add(printable(type.fields[i].name, limits_.max_string));
                add(": ");
                field(value, i);
                is_first = false;
            }
            --depth_;
        }
        add("}");
    }
    void variant(const Variant& value, const DynamicType* type = nullptr)
    {
        if (value.is_null()) {
            return add("null");
        }
        busbar::detail::visit_built_in(value.type(), [&](auto tag) {
            using T = typename decltype(tag)::type;
            if (const auto* const values = value.array_if<T>()) {
                array(*values, value.dimensions(), [&](const T& element) { print(element, type); });
            } else if constexpr (!std::is_same_v<T, Variant>) {
                print(*value.get_if<T>(), type);
            }
        });
    }

private:
    void add(std::string_view part)
    {
        if (is_full_) {
            return;
        }
        text_ += part;
        if (text_.size() >= limits_.max_bytes) {
            text_ += "...";
            is_full_ = true;
        }
    }
    /// Returns false, with "..." instead, if the text is full or the value is nested too deep.
    [[nodiscard]] bool enter()
    {
        if (is_full_ || depth_ >= limits_.max_depth) {
            add("...");
            return false;
        }
        ++depth_;
        return true;
    }

    void field(const DynamicValue& value, std::size_t index)
    {
        if (const Variant* const content = value.value(index)) {
            variant(*content, value.type().fields[index].type);
        } else if (const DynamicValue* const part = value.structure(index)) {
            structure(*part);
        } else if (const DynamicArray* const parts = value.structures(index)) {
            array(parts->values, parts->dimensions.span(),
                  [this](const DynamicValue& element) { structure(element); });
        }
    }
    /// "[1, 2]", with the dimensions of a matrix in front: "2x3 [...]".
    template <typename T, typename Print>
    void array(const Array<T>& values, std::span<const std::uint32_t> dimensions, Print print_one)
    {
        if (values.is_null() && dimensions.empty()) {
            return add("null");
        }
        for (std::size_t i = 0; i < dimensions.size() && !is_full_; ++i) {
            add(i == 0 ? "" : "x");
            add(std::to_string(dimensions[i]));
        }
        add(dimensions.empty() ? "[" : " [");
        for (std::size_t i = 0; i < values.size() && !is_full_; ++i) {
            add(i == 0 ? "" : ", ");
            if (i == limits_.max_elements || !enter()) {
                add("...");
                break;
            }
            print_one(values[i]);
            --depth_;
        }
        add("]");
    }

    void quoted(std::string_view value)
    {
        std::string escaped;
        for (const char c : printable(value, limits_.max_string)) {
            escaped += c == '"' ? "\\\"" : std::string(1, c);
        }
        add("\"" + escaped + "\"");
    }
    template <typename T>
    requires std::is_arithmetic_v<T>
    void print(T value, const DynamicType* type)
    {
        if constexpr (std::is_same_v<T, bool>) {
            add(value ? "true" : "false");
        } else {
            char digits[32];
            const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
            const std::string_view number{digits, static_cast<std::size_t>(end - digits)};
            if constexpr (std::is_integral_v<T>) {
                if (!add_iec(type, static_cast<std::int64_t>(value))) {
                    named_number(static_cast<std::uint64_t>(value), number, type);
                }
            } else {
                add(limits_.max_digits == 0 ? std::string{number}
                                            : rounded(static_cast<double>(value)));
            }
        }
    }
    /// Returns false, with nothing added, if it is not a time of IEC 61131-3.
    template <typename T>
    [[nodiscard]] bool add_iec(const DynamicType* type, T value)
    {
        const auto known = detail::iec_type(type);
        const std::string text = known ? detail::iec_text(*known, value) : std::string{};
        add(text);
        return !text.empty();
    }
    [[nodiscard]] std::string rounded(double value) const
    {
        const int digits = limits_.max_digits;
        const double size = std::abs(value);
        // Larger and smaller numbers are easier to read with an exponent.
        const bool is_plain = size == 0 || (size >= 1e-4 && size < 1e15);
        char text[64];
        const int before =
            is_plain && size > 0 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 1;
        std::snprintf(text, sizeof text, is_plain ? "%.*f" : "%.*g",
                      is_plain ? std::max(0, digits - before) : digits, value);
        std::string result{text};
        if (is_plain && result.find('.') != std::string::npos) {
            result.erase(result.find_last_not_of('0') + 1);
            if (result.ends_with('.')) {
                result.pop_back();
            }
        }
        return result == "-0" ? "0" : result;
    }
    /// "Running (1)", "Read | Write (3)", or the number alone.
    void named_number(std::uint64_t value, std::string_view number, const DynamicType* type)
    {
        std::string names;
        for (const DynamicType::Value& known :
             type == nullptr ? std::span<const DynamicType::Value>{} : std::span{type->values}) {
            const auto place = static_cast<std::uint64_t>(known.value);
            const bool is_meant = type->kind == DynamicType::Kind::OptionSet
                                      ? place < 64 && (value >> place & 1U) != 0
                                      : place == value;
            if (is_meant && names.size() < limits_.max_string) {
                names += (names.empty() ? "" : " | ") + printable(known.name, limits_.max_string);
            }
        }
        add(names.empty() ? std::string{number} : names + " (" + std::string{number} + ")");
    }
    void print(const String& value, const DynamicType* /*type*/)
    {
        value.is_null() ? add("null") : quoted(value.view());
    }
    void print(const ByteString& value, const DynamicType* /*type*/)
    {
        constexpr std::string_view digits = "0123456789ABCDEF";
        if (value.is_null()) {
            return add("null");
        }
        std::string text = "0x";
        for (const std::byte byte : value.span()) {
            if (text.size() / 2 > limits_.max_elements) {
                text += "...";
                break;
            }
            text += digits[std::to_integer<std::size_t>(byte >> 4)];
            text += digits[std::to_integer<std::size_t>(byte & std::byte{15})];
        }
        add(text);
    }
    void print(const DateTime& value, const DynamicType* type)
    {
        if (!add_iec(type, value)) {
            add(value.is_null() ? "null" : to_string(value));
        }
    }
    void print(const Guid& value, const DynamicType* /*type*/) { add(to_string(value)); }
    void print(const NodeId& value, const DynamicType* /*type*/)
    {
        add(printable(to_string(value), limits_.max_string));
    }
    void print(const ExpandedNodeId& value, const DynamicType* /*type*/)
    {
        add(printable(to_string(value), limits_.max_string));
    }
    void print(const StatusCode& value, const DynamicType* type)
    {
        const std::string_view known = name(value);
        known.empty() ? print(value.value(), type) : add(known);
    }
    void print(const QualifiedName& value, const DynamicType* /*type*/)
    {
        quoted(to_string(value));
    }
    void print(const LocalizedText& value, const DynamicType* type)
    {
        print(value.text, type);
        if (!value.locale.empty()) {
            add("@" + printable(value.locale.view(), limits_.max_string));
        }
    }
    /// Prints a structure with its fields, if its definition is known and the body matches it.
    [[nodiscard]] bool known_structure(const ExtensionObject& value)
    {
        const auto known = types_ == nullptr || is_full_ ? fail(status::Bad_DecodingError)
                                                         : decode_dynamic(value, *types_);
        if (known && enter()) {
            structure(*known);
            --depth_;
        }
        return known.has_value();
    }
    void print(const ExtensionObject& value, const DynamicType* type)
    {
        if (value.is_null()) {
            return add("null");
        }
        if (known_structure(value)) {
            return;
        }
        print(value.encoding_id(), type);
        if (value.type() != nullptr) {
            add(" " + std::string{value.type()->name});
        } else if (value.body() == ExtensionObject::Body::Xml) {
            add(" ");
            print(value.xml(), type);
        } else if (value.body() == ExtensionObject::Body::Binary) {
            add(" ");
            print(value.binary(), type);
        }
    }
    void print(const DataValue& value, const DynamicType* type)
    {
        print(value.value, type);
        add(" ");
        print(value.status, nullptr);
    }
    void print(const Variant& value, const DynamicType* /*type*/)
    {
        if (enter()) {
            variant(value);
            --depth_;
        }
    }
    void print(const DiagnosticInfo& value, const DynamicType* type)
    {
        if (!value.additional_info) {
            return add("DiagnosticInfo");
        }
        print(*value.additional_info, type);
    }

    TextLimits limits_;
    const DynamicTypes* types_;
    std::string text_;
    std::size_t depth_{0};
    bool is_full_{false};
};

} // namespace

std::string to_text(const DynamicValue& value, const TextLimits& limits, const TextTypes& types)
{
    TextWriter writer{limits, types.types};
    writer.structure(value);
    return writer.take();
}

std::string to_text(const Variant& value, const TextLimits& limits, const TextTypes& types)
{
    TextWriter writer{limits, types.types};
    writer.variant(value, types.type);
    return writer.take();
}

} // namespace busbar::binary
