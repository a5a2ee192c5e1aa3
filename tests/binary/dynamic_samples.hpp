#pragma once

#include "dynamic_fixture.hpp"

/// Values of the fixture's types.
namespace busbar::test {

using binary::decode_dynamic;
using binary::to_extension_object;

inline DynamicValue full_part()
{
    DynamicValue part = make(types::Part);
    DynamicValue shape = make(types::Shape);
    REQUIRE(shape.set("Path", DynamicArray{{point(1, 2), point(3, 4)}, {}}));
    DynamicArray grid{{}, {2U, 3U}};
    for (int i = 0; i < 6; ++i) {
        grid.values.push_back(point(i, -i));
    }
    REQUIRE(part.set("Name", Variant{"left \"rail\"\n"}));
    REQUIRE(part.set("Size", Variant{2.5}));
    REQUIRE(part.set("Flags", Variant{std::uint16_t{5}}));
    REQUIRE(part.set("Shape", shape));
    REQUIRE(part.set("Corners", DynamicArray{{point(0, 0)}, {}}));
    REQUIRE(part.set("Grid", grid));
    REQUIRE(part.set("Counts", Variant{Array<std::int16_t>{1, -2}}));
    REQUIRE(part.set("Matrix", Variant::matrix(Array<float>{1, 2, 3, 4}, {2U, 2U})));
    REQUIRE(part.set("Anything", Variant{Array<String>{"a", String{}}}));
    return part;
}

inline DynamicValue full_measurement()
{
    DynamicValue value = make(types::Measurement);
    REQUIRE(value.set("At", point(1, 2)));
    REQUIRE(value.set("Comment", Variant{"ok"}));
    REQUIRE(value.set("Mode", Variant{std::int32_t{2}}));
    REQUIRE(value.set("Trace", DynamicArray{{point(5, 6)}, {}}));
    return value;
}

inline DynamicValue full_container()
{
    DynamicValue value = make(types::Container);
    DynamicValue place = make(types::Point3D);
    REQUIRE(place.set("Z", Variant{3.0}));
    REQUIRE(value.set("Any", full_measurement()));
    REQUIRE(value.set("Place", place));
    REQUIRE(value.set("Amount", Variant{std::uint8_t{7}}));
    REQUIRE(
        value.set("Places", Variant{Array<ExtensionObject>{to_extension_object(place).value()}}));
    return value;
}

inline std::vector<DynamicValue> samples()
{
    DynamicValue choice = make(types::Choice);
    REQUIRE(choice.set("Text", Variant{"x"}));
    DynamicValue tree = make(types::Tree);
    REQUIRE(tree.set("Children", DynamicArray{{tree, tree}, {}}));
    std::vector<DynamicValue> result{full_part(), full_measurement(), full_container(), choice,
                                     tree};
    for (std::uint32_t type = types::Point; type <= types::Bits; ++type) {
        if (!plant().find(type_id(type))->encoding_id.is_null()) {
            result.push_back(make(type));
        }
    }
    return result;
}

inline std::vector<std::byte> bytes_of(const DynamicValue& value)
{
    const auto bytes = binary::to_bytes(value);
    REQUIRE(bytes);
    return *bytes;
}

} // namespace busbar::test
