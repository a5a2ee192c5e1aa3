#pragma once

#include <optional>
#include <string>
#include <vector>

#include <busbar/client/value_text.hpp>

#include "core/json.hpp"

namespace busbar::client::detail {

using busbar::detail::Json;

/// Creates values from the result of parse_json. The first failure stays in error().
class TextValueReader {
public:
    /// `types`, which may be null, has the structures that objects name; `base`, which may be null,
    /// the fields that they do not name.
    TextValueReader(const binary::DynamicTypes* types, const Variant* base)
        : types_{types}, base_{base}
    {
    }

    /// Returns nothing, with error(), if `from` is not a value of this type.
    [[nodiscard]] std::optional<Variant> read(const Json& from, const ValueType& type);
    /// "[3]: expected a Byte, 0 to 255, found 300"
    [[nodiscard]] const std::string& error() const { return error_; }

private:
    /// The elements of nested lists and how many there are in each dimension.
    struct Elements {
        std::vector<const Json*> values;
        std::vector<std::uint32_t> dimensions;
    };

    [[nodiscard]] std::optional<Variant> read_any(const Json& from);
    [[nodiscard]] std::optional<Variant> read_typed(const Json& from);
    [[nodiscard]] std::optional<Elements> elements_of(const Json& from, std::int32_t rank);
    [[nodiscard]] bool collect(const Json& from, std::size_t level, Elements& to);
    [[nodiscard]] std::optional<Variant> read_array(const Elements& from, const ValueType& type);
    template <typename T>
    [[nodiscard]] bool read_one(const Json& from, const ValueType& type, T& to);
    template <typename T>
    [[nodiscard]] bool read_number(const Json& from, const binary::DynamicType& type, T& to);
    [[nodiscard]] bool read_object(const Json& from, const binary::DynamicType* type,
                                   ExtensionObject& to);
    /// Fields that are not named are those of `base`, which may be null.
    [[nodiscard]] std::optional<binary::DynamicValue>
    read_structure(const Json& from, const binary::DynamicType& type,
                   const binary::DynamicValue* base = nullptr);
    /// Returns false if a field is missing that is not optional.
    [[nodiscard]] bool names_all(const Json& from, const binary::DynamicType& type);
    /// The value of `base_` if it is of this type; it counts for the outermost structure only.
    [[nodiscard]] std::optional<binary::DynamicValue> take_base(const binary::DynamicType& type);
    /// `keeps`: fields of a structure in it that are not named stay as they are.
    [[nodiscard]] bool read_field(const Json& from, std::size_t field, bool keeps,
                                  binary::DynamicValue& to);
    [[nodiscard]] bool read_structures(const Json& from, std::size_t field,
                                       binary::DynamicValue& to);

    std::nullopt_t fail(const Json& found, std::string_view expected);
    /// Puts the place of the failure before its description.
    void within(const std::string& place);

    const binary::DynamicTypes* types_;
    const Variant* base_;
    std::string error_;
};

} // namespace busbar::client::detail
