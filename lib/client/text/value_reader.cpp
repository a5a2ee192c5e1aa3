#include "value_reader.hpp"

#include <utility>

#include "binary/dynamic/iec_type.hpp"
#include "core/visit_built_in.hpp"
#include "scalar_reader.hpp"

namespace busbar::client::detail {

namespace {

using binary::DynamicType;
using binary::DynamicValue;

/// Part 3, 5.6.2: what a ValueRank allows.
bool may_be_scalar(std::int32_t rank)
{
    return rank < 0;
}
bool may_be_array(std::int32_t rank)
{
    return rank != -1;
}

/// Returns the type of a text without a type.
BuiltInType guessed_type(const Json& from)
{
    std::int64_t number = 0;
    switch (from.kind) {
    case Json::Kind::True:
    case Json::Kind::False:
        return BuiltInType::Boolean;
    case Json::Kind::Number:
        if (!read_scalar(from, number)) {
            return BuiltInType::Double;
        }
        return number >= INT32_MIN && number <= INT32_MAX ? BuiltInType::Int32 : BuiltInType::Int64;
    default:
        return BuiltInType::String;
    }
}

/// Returns one type for all elements of a list.
BuiltInType guessed_type(const std::vector<const Json*>& values)
{
    BuiltInType type = values.empty() ? BuiltInType::String : guessed_type(*values.front());
    for (const Json* const value : values) {
        const BuiltInType other = guessed_type(*value);
        const bool are_numbers = type >= BuiltInType::Int32 && type <= BuiltInType::Double &&
                                 other >= BuiltInType::Int32 && other <= BuiltInType::Double;
        type = are_numbers ? std::max(type, other) : type;
    }
    return type;
}

/// Reads a literal of IEC 61131-3 if the type, which may be null, is one that has them.
template <typename T>
bool read_iec(const Json& from, const DynamicType* type, T& to)
{
    const auto known =
        from.kind == Json::Kind::String ? binary::detail::iec_type(type) : std::nullopt;
    if (!known) {
        return false;
    }
    if constexpr (std::is_same_v<T, DateTime>) {
        const auto time = binary::detail::iec_time(*known, from.text);
        to = time.value_or(to);
        return time.has_value();
    } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
        const auto number = binary::detail::iec_number(*known, from.text);
        const bool fits = number && std::in_range<T>(*number);
        to = fits ? static_cast<T>(*number) : to;
        return fits;
    } else {
        return false;
    }
}

/// Sets an array to what it is in a new value.
bool set_default(std::size_t field, DynamicValue& to)
{
    const DynamicValue empty{to.type()};
    if (const Variant* const content = empty.value(field)) {
        return to.set(field, *content).has_value();
    }
    if (const auto* const structures = empty.structures(field)) {
        return to.set(field, *structures).has_value();
    }
    return true;
}

} // namespace

std::nullopt_t TextValueReader::fail(const Json& found, std::string_view expected)
{
    error_ = "expected " + std::string{expected} + ", found " + found.describe();
    return std::nullopt;
}

void TextValueReader::within(const std::string& place)
{
    error_ = place + (error_.starts_with('[') || error_.starts_with('.') ? "" : ": ") + error_;
}

template <typename T>
bool TextValueReader::read_number(const Json& from, const DynamicType& type, T& to)
{
    if (read_scalar(from, to)) {
        return true;
    }
    const auto number =
        from.kind == Json::Kind::String ? number_of_name(from.text, type) : std::nullopt;
    to = number ? static_cast<T>(*number) : T{};
    if (!number) {
        static_cast<void>(fail(from, expectation(type)));
    }
    return number.has_value();
}

template <typename T>
bool TextValueReader::read_one(const Json& from, const ValueType& type, T& to)
{
    if constexpr (std::is_same_v<T, Variant>) {
        auto value = read_any(from);
        const bool is_read = value.has_value();
        to = is_read ? *std::move(value) : Variant{};
        return is_read;
    } else if constexpr (std::is_same_v<T, ExtensionObject>) {
        return read_object(from, type.type, to);
    } else if constexpr (std::is_same_v<T, DataValue> || std::is_same_v<T, DiagnosticInfo>) {
        static_cast<void>(fail(from, "a type that has a text form"));
        return false;
    } else {
        if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
            if (type.type != nullptr && !type.type->values.empty()) {
                return read_number(from, *type.type, to);
            }
        }
        if (read_iec(from, type.type, to)) {
            return true;
        }
        const bool is_read = read_scalar(from, to);
        if (!is_read) {
            static_cast<void>(fail(from, expectation(type.built_in, type.type)));
        }
        return is_read;
    }
}

std::optional<Variant> TextValueReader::read(const Json& from, const ValueType& type)
{
    if (type.built_in == BuiltInType::Variant && from.kind != Json::Kind::List) {
        return read_any(from);
    }
    if (from.kind == Json::Kind::List && may_be_array(type.value_rank)) {
        auto elements = elements_of(from, type.value_rank);
        return elements ? read_array(*elements, type) : std::nullopt;
    }
    if (!may_be_scalar(type.value_rank)) {
        return fail(from, "a list such as [1, 2]");
    }
    return busbar::detail::visit_built_in(type.built_in, [&](auto tag) -> std::optional<Variant> {
        using T = typename decltype(tag)::type;
        if constexpr (std::is_same_v<T, Variant>) {
            return fail(from, "a scalar");
        } else {
            T value{};
            return read_one(from, type, value) ? std::optional{Variant{std::move(value)}}
                                               : std::nullopt;
        }
    });
}

std::optional<Variant> TextValueReader::read_any(const Json& from)
{
    if (from.kind == Json::Kind::Null) {
        return Variant{};
    }
    if (from.kind == Json::Kind::Object) {
        return read_typed(from);
    }
    return read(from, {guessed_type(from), -1, nullptr});
}

/// Reads the form of to_json: {"UaType": 6, "Value": [1, 2], "Dimensions": [2, 1]}.
std::optional<Variant> TextValueReader::read_typed(const Json& from)
{
    const Json* const type = from.find("UaType");
    const Json* const value = from.find("Value");
    std::uint8_t number = 0;
    if (type == nullptr || value == nullptr || !read_scalar(*type, number) || number == 0 ||
        number > last_built_in_type) {
        return fail(from, "an object with UaType and Value");
    }
    const bool is_list = value->kind == Json::Kind::List;
    const ValueType known{BuiltInType{number}, is_list ? 1 : -1, nullptr};
    const Json* const dimensions = from.find("Dimensions");
    if (!is_list || dimensions == nullptr) {
        return read(*value, known);
    }
    Elements elements;
    std::size_t product = 1;
    for (const Json& item : value->items) {
        elements.values.push_back(&item);
    }
    for (const Json& item : dimensions->items) {
        if (!read_scalar(item, elements.dimensions.emplace_back())) {
            return fail(item, "a dimension");
        }
        // Stops growing when it is too large anyway.
        product = std::min<std::size_t>(product, UINT32_MAX) * elements.dimensions.back();
    }
    if (product != elements.values.size()) {
        return fail(*dimensions, "Dimensions whose product is the number of values");
    }
    return read_array(elements, known);
}

std::optional<TextValueReader::Elements> TextValueReader::elements_of(const Json& from,
                                                                      std::int32_t rank)
{
    Elements elements;
    const Json* at = &from;
    // Part 3, 5.6.2: -3 is a scalar or an array of one dimension.
    const std::size_t any = rank == -3 ? 1 : SIZE_MAX;
    const std::size_t levels = rank > 0 ? static_cast<std::size_t>(rank) : any;
    while (at->kind == Json::Kind::List && elements.dimensions.size() < levels) {
        elements.dimensions.push_back(static_cast<std::uint32_t>(at->items.size()));
        if (at->items.empty()) {
            break;
        }
        at = &at->items.front();
    }
    if (rank > 1 && elements.dimensions.size() == 1 && from.items.empty()) {
        elements.dimensions.resize(levels, 0); // an empty matrix
        return elements;
    }
    if (rank > 0 && elements.dimensions.size() != levels) {
        return fail(from, "lists within lists, " + std::to_string(rank) + " levels");
    }
    return collect(from, 0, elements) ? std::optional{std::move(elements)} : std::nullopt;
}

bool TextValueReader::collect(const Json& from, std::size_t level, Elements& to)
{
    if (level == to.dimensions.size()) {
        to.values.push_back(&from);
        return true;
    }
    if (from.kind != Json::Kind::List || from.items.size() != to.dimensions[level]) {
        static_cast<void>(
            fail(from, "a list of " + std::to_string(to.dimensions[level]) + " like the others"));
        return false;
    }
    for (const Json& item : from.items) {
        if (!collect(item, level + 1, to)) {
            return false;
        }
    }
    return true;
}

std::optional<Variant> TextValueReader::read_array(const Elements& from, const ValueType& type)
{
    // Elements of an array of Variants may differ; those of a value of any type should not.
    const bool is_guess = type.built_in == BuiltInType::Variant && type.value_rank == -2;
    const ValueType element{is_guess ? guessed_type(from.values) : type.built_in, -1, type.type};
    return busbar::detail::visit_built_in(
        element.built_in, [&](auto tag) -> std::optional<Variant> {
            using T = typename decltype(tag)::type;
            Array<T> values(from.values.size());
            for (std::size_t i = 0; i < values.size(); ++i) {
                if (!read_one(*from.values[i], element, values[i])) {
                    within("[" + std::to_string(i) + "]");
                    return std::nullopt;
                }
            }
            return Variant::matrix(std::move(values), Array<std::uint32_t>{from.dimensions});
        });
}

/// Reads by fields, of the named type or else of `type`, or encoded as in to_json.
bool TextValueReader::read_object(const Json& from, const DynamicType* type, ExtensionObject& to)
{
    NodeId id;
    ByteString body;
    const Json* const named = from.find("UaTypeId");
    const Json* const encoded = from.find("UaBody");
    if (from.kind == Json::Kind::Null) {
        to = {};
        return true;
    }
    if (named != nullptr && !read_scalar(*named, id)) {
        static_cast<void>(fail(*named, "the NodeId of a type"));
        return false;
    }
    if (named != nullptr && encoded != nullptr && read_scalar(*encoded, body)) {
        to = ExtensionObject::from_binary(std::move(id), std::move(body));
        return true;
    }
    const DynamicType* const found =
        named != nullptr && types_ != nullptr ? types_->find(id) : type;
    if (found == nullptr) {
        static_cast<void>(fail(from, "a structure of a type that is known"));
        return false;
    }
    const auto base = take_base(*found);
    const auto value = read_structure(from, *found, base ? &*base : nullptr);
    auto object =
        value ? binary::to_extension_object(*value) : busbar::fail(status::Bad_EncodingError);
    if (value && !object) {
        static_cast<void>(fail(from, "a type with an encoding"));
    }
    const bool is_made = object.has_value();
    to = is_made ? *std::move(object) : ExtensionObject{};
    return is_made;
}

std::optional<DynamicValue> TextValueReader::take_base(const DynamicType& type)
{
    const Variant* const base = std::exchange(base_, nullptr);
    const auto* const object = base == nullptr ? nullptr : base->get_if<ExtensionObject>();
    auto value = object != nullptr && types_ != nullptr ? binary::decode_dynamic(*object, *types_)
                                                        : busbar::fail(status::Bad_NotFound);
    const bool fits = value && value->type().id == type.id;
    return fits ? std::optional{*std::move(value)} : std::nullopt;
}

bool TextValueReader::names_all(const Json& from, const DynamicType& type)
{
    std::string missing;
    for (const binary::DynamicField& field : type.fields) {
        if (!field.is_optional && from.find(field.name) == nullptr && missing.size() < 256) {
            missing += (missing.empty() ? "" : ", ") + printable(field.name, 64);
        }
    }
    if (type.kind == DynamicType::Kind::Union || missing.empty()) {
        return true;
    }
    error_ = printable(type.name) + " is not complete, these fields are missing: " + missing;
    return false;
}

std::optional<DynamicValue>
TextValueReader::read_structure(const Json& from, const DynamicType& type, const DynamicValue* base)
{
    if (from.kind != Json::Kind::Object || !type.is_structure()) {
        return fail(from, "an object with the fields of " + printable(type.name));
    }
    DynamicValue value = base != nullptr ? *base : DynamicValue{type};
    for (std::size_t i = 0; i < from.items.size(); ++i) {
        const auto field = type.find_field(from.names[i]);
        if (from.names[i] == "UaTypeId" && !field) {
            continue;
        }
        if (!field) {
            error_ = printable(type.name) + " has no field " + printable(from.names[i], 64);
            return std::nullopt;
        }
        const bool is_absent =
            from.items[i].kind == Json::Kind::Null && type.fields[*field].is_optional;
        if (is_absent) {
            static_cast<void>(value.clear(*field));
        } else if (!read_field(from.items[i], *field, base != nullptr, value)) {
            within("." + printable(from.names[i], 64));
            return std::nullopt;
        }
    }
    return base != nullptr || names_all(from, type) ? std::optional{std::move(value)}
                                                    : std::nullopt;
}

bool TextValueReader::read_field(const Json& from, std::size_t field, bool keeps, DynamicValue& to)
{
    const binary::DynamicField& known = to.type().fields[field];
    if (!known.is_scalar() && from.kind == Json::Kind::Null) {
        return set_default(field, to);
    }
    if (known.is_structure && !known.is_scalar()) {
        return read_structures(from, field, to);
    }
    Result<void> is_set;
    if (known.is_structure) {
        // What is not named within it stays, too.
        const DynamicValue* const before = keeps ? to.structure(field) : nullptr;
        auto part = read_structure(from, *known.type, before);
        if (!part) {
            return false;
        }
        is_set = to.set(field, *std::move(part));
    } else {
        auto part = read(from, {known.built_in, known.value_rank, known.type});
        if (!part) {
            return false;
        }
        is_set = to.set(field, *std::move(part));
    }
    if (!is_set) {
        static_cast<void>(fail(from, "a value that the field can hold"));
    }
    return is_set.has_value();
}

bool TextValueReader::read_structures(const Json& from, std::size_t field, DynamicValue& to)
{
    const binary::DynamicField& known = to.type().fields[field];
    if (from.kind != Json::Kind::List) {
        static_cast<void>(fail(from, "a list such as [1, 2]"));
        return false;
    }
    const auto elements = elements_of(from, known.value_rank);
    if (!elements) {
        return false;
    }
    binary::DynamicArray parts;
    parts.values.reserve(elements->values.size());
    for (std::size_t i = 0; i < elements->values.size(); ++i) {
        auto part = read_structure(*elements->values[i], *known.type);
        if (!part) {
            within("[" + std::to_string(i) + "]");
            return false;
        }
        parts.values.push_back(*std::move(part));
    }
    if (elements->dimensions.size() > 1) {
        parts.dimensions = Array<std::uint32_t>{elements->dimensions};
    }
    return to.set(field, std::move(parts)).has_value();
}

} // namespace busbar::client::detail
