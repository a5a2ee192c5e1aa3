#include "value_lines.hpp"

#include <algorithm>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/client/value_text.hpp>

#include "display_text.hpp"

namespace busbar::tool {

namespace {

using binary::DynamicArray;
using binary::DynamicType;
using binary::DynamicValue;

/// Arrays that are no longer than this stay on the line of their name.
constexpr std::size_t max_inline_columns = 40;

template <typename T>
void append_elements(const Variant& value, std::size_t count, std::vector<Variant>& elements)
{
    if (const auto* const array = value.array_if<T>()) {
        for (std::size_t i = 0; i < std::min(count, array->size()); ++i) {
            elements.push_back(Variant{(*array)[i]});
        }
    }
}

/// The first `count` elements of an array, each as a value of its own.
std::vector<Variant> elements_of(const Variant& value, std::size_t count)
{
    std::vector<Variant> elements;
    const auto append = [&]<typename... T>() { (append_elements<T>(value, count, elements), ...); };
    append.operator()<bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                      std::uint32_t, std::int64_t, std::uint64_t, float, double, String, DateTime,
                      Guid, ByteString, XmlElement, NodeId, ExpandedNodeId, StatusCode,
                      QualifiedName, LocalizedText, ExtensionObject, DataValue, DiagnosticInfo>();
    if (const auto* const variants = value.array_if<Variant>()) {
        elements.assign(variants->begin(), variants->begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                   count, variants->size())));
    }
    return elements;
}

bool is_number(BuiltInType type)
{
    return type >= BuiltInType::SByte && type <= BuiltInType::Double;
}

std::string index_text(std::size_t index)
{
    return "[" + std::to_string(index) + "]";
}

class Dissector {
public:
    Dissector(const Types& types, std::size_t limit) : types_{types}, limit_{limit} {}

    [[nodiscard]] ValuePart part(const Variant& value, const DynamicType* type) const
    {
        if (value.is_array()) {
            return array_part(value, type);
        }
        if (const auto* const object = value.get_if<ExtensionObject>()) {
            const auto known =
                types_ ? binary::decode_dynamic(*object, *types_) : fail(status::Bad_DecodingError);
            if (known) {
                return structure_part(*known);
            }
        }
        return {{}, line(value, type), {}, {}};
    }

private:
    [[nodiscard]] std::size_t most() const { return limit_ == 0 ? SIZE_MAX : limit_; }

    [[nodiscard]] std::string line(const Variant& value, const DynamicType* type) const
    {
        client::TextOptions options;
        options.types = types_.get();
        options.type = type;
        if (limit_ == 0) {
            options.limits = {SIZE_MAX / 8, SIZE_MAX / 8, SIZE_MAX / 8};
        }
        return safe(client::to_text(value, options));
    }
    [[nodiscard]] ValuePart structure_part(const DynamicValue& value) const
    {
        ValuePart part;
        part.text = safe(value.type().name);
        for (std::size_t i = 0; i < value.type().fields.size(); ++i) {
            if (value.has(i)) {
                part.parts.push_back(field_part(value, i));
                part.parts.back().name = safe(value.type().fields[i].name);
            }
        }
        if (part.parts.empty()) {
            part.text += " {}";
        }
        return part;
    }
    [[nodiscard]] ValuePart field_part(const DynamicValue& value, std::size_t index) const
    {
        if (const Variant* const content = value.value(index)) {
            return part(*content, value.type().fields[index].type);
        }
        if (const DynamicValue* const structure = value.structure(index)) {
            return structure_part(*structure);
        }
        const DynamicArray* const structures = value.structures(index);
        return structures == nullptr ? ValuePart{} : structures_part(*structures);
    }
    [[nodiscard]] ValuePart structures_part(const DynamicArray& structures) const
    {
        if (structures.values.empty()) {
            return {{}, structures.values.is_null() ? "null" : "[]", {}, {}};
        }
        ValuePart part;
        part.text = safe(structures.values.front().type().name) +
                    shape(structures.values.size(), structures.dimensions.span());
        for (std::size_t i = 0; i < std::min(most(), structures.values.size()); ++i) {
            part.parts.push_back(structure_part(structures.values[i]));
            part.parts.back().name = index_text(i);
        }
        part.left_out = structures.values.size() - part.parts.size();
        return part;
    }
    /// "[1000]", or "[3][4]" of a matrix.
    [[nodiscard]] static std::string shape(std::size_t count,
                                           std::span<const std::uint32_t> dimensions)
    {
        std::string text = dimensions.empty() ? index_text(count) : "";
        for (const std::uint32_t dimension : dimensions) {
            text += index_text(dimension);
        }
        return text;
    }
    [[nodiscard]] ValuePart array_part(const Variant& value, const DynamicType* type) const
    {
        const std::size_t count = value.array_size();
        const auto elements = elements_of(value, most());
        ValuePart part;
        part.text = std::string{name(value.type())} + shape(count, value.dimensions());
        part.has_numbers = is_number(value.type()) && (type == nullptr || type->values.empty());
        part.left_out = count - elements.size();
        bool is_simple = true;
        for (std::size_t i = 0; i < elements.size(); ++i) {
            ValuePart& element = part.parts.emplace_back(this->part(elements[i], type));
            element.name = index_text(i);
            is_simple = is_simple && element.is_simple();
        }
        if (!is_simple) {
            return part;
        }
        for (ValuePart& element : part.parts) {
            part.cells.push_back(std::move(element.text));
        }
        part.parts.clear();
        if (value.is_matrix()) {
            split_rows(part, value.dimensions());
            return part;
        }
        const std::string whole = line(value, type);
        const bool is_short = count < 32 && display_width(whole) <= max_inline_columns;
        return count == 0 || is_short ? ValuePart{{}, whole, {}, {}} : part;
    }
    /// One row for each index of all dimensions but the last.
    static void split_rows(ValuePart& matrix, std::span<const std::uint32_t> dimensions)
    {
        const std::size_t size = dimensions.back();
        for (std::size_t first = 0; size != 0 && first < matrix.cells.size(); first += size) {
            ValuePart& row = matrix.parts.emplace_back();
            std::size_t index = first / size;
            for (std::size_t i = dimensions.size() - 1; i-- > 0;) {
                row.name.insert(0, index_text(index % dimensions[i]));
                index /= dimensions[i];
            }
            const std::size_t end = std::min(first + size, matrix.cells.size());
            for (std::size_t i = first; i < end; ++i) {
                row.cells.push_back(std::move(matrix.cells[i]));
            }
            row.has_numbers = matrix.has_numbers;
        }
        matrix.cells.clear();
    }

    const Types& types_;
    std::size_t limit_;
};

} // namespace

ValuePart parts_of(const Variant& value, const Types& types, std::size_t limit,
                   const DynamicType* type)
{
    return Dissector{types, limit}.part(value, type);
}

} // namespace busbar::tool
