#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/types/registry.hpp>
#include <busbar/types/types.hpp>

#include "dynamic_samples.hpp"
#include "support/allocation_count.hpp"
#include "support/random_dynamic.hpp"

namespace dynamic_check_test {

using namespace busbar;
using namespace busbar::test;
using binary::check_dynamic;

namespace {

/// Every built-in type as scalar, array and matrix.
DynamicTypes built_in_types()
{
    static std::vector<std::string> names;
    std::vector<DataTypeEntry> entries;
    std::uint32_t number = 0;
    for (const std::int32_t rank : {-1, 1, 2}) {
        DataTypeEntry entry = structure(++number, "All", Shape::Structure, {});
        auto& fields = std::get<StructureDefinition>(entry.definition).fields;
        for (std::uint32_t type = 1; type <= last_built_in_type; ++type) {
            names.push_back("F" + std::to_string(type));
            fields.push_back(field(names.back().c_str(), type, rank));
        }
        entries.push_back(std::move(entry));
    }
    return DynamicTypes::compile(std::move(entries));
}

Variant object_of(const DynamicType& type, std::span<const std::byte> body)
{
    return Variant{ExtensionObject::from_binary(type.encoding_id, ByteString{body})};
}

StatusCode decoded(const DynamicType& type, std::span<const std::byte> body)
{
    return status_of(decode_dynamic(body, type));
}

/// Cuts and changes a body everywhere and compares the check with the decoder.
void compare_everywhere(const DynamicTypes& types, const DynamicValue& value, std::uint32_t seed)
{
    const DynamicType& type = value.type();
    auto bytes = bytes_of(value);
    // Only the check, which is a server's, refuses texts that are not UTF-8.
    const auto is_other_text = [](std::span<const std::byte> body) {
        return std::any_of(body.begin(), body.end(),
                           [](std::byte byte) { return byte >= std::byte{0x80}; });
    };
    const auto same = [&](std::span<const std::byte> body) {
        const StatusCode checked = check_dynamic(object_of(type, body), types);
        const StatusCode read = decoded(type, body);
        return checked == read || (checked == status::Bad_DecodingError && is_other_text(body));
    };
    REQUIRE(same(bytes));
    REQUIRE(check_dynamic(object_of(type, bytes), types) == status::Good);
    std::mt19937 random{seed};
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        INFO(type.name << " at " << at);
        REQUIRE(same(std::span{bytes}.first(at)));
        const std::byte kept = bytes[at];
        bytes[at] = static_cast<std::byte>(random());
        REQUIRE(same(bytes));
        bytes[at] = static_cast<std::byte>(random() % 32);
        REQUIRE(same(bytes));
        bytes[at] = kept;
    }
    bytes.push_back(std::byte{0});
    REQUIRE(same(bytes));
}

StructureField limited(const char* name, std::uint32_t type, std::int32_t rank,
                       std::initializer_list<std::uint32_t> dimensions, std::uint32_t length)
{
    StructureField result = field(name, type, rank);
    result.array_dimensions = dimensions;
    result.max_string_length = length;
    return result;
}

DynamicTypes limited_types()
{
    return DynamicTypes::compile(
        {structure(1, "Limited", Shape::Structure,
                   {limited("Name", id::String, -1, {}, 4),
                    limited("Raw", id::ByteString, -1, {}, 4),
                    limited("Title", id::LocalizedText, -1, {}, 4),
                    limited("Names", id::String, 1, {2}, 3),
                    limited("Matrix", id::Int32, 2, {2, 0}, 0), field("Numbers", id::Int32, 1)}),
         structure(2, "Outer", Shape::Structure,
                   {field("Parts", type_id(1), 1), field("Any", id::BaseDataType)})});
}

} // namespace

TEST_CASE("a structure is checked as it is decoded", "[binary][dynamic]")
{
    const DynamicTypes built_in = built_in_types();
    REQUIRE(built_in.errors().empty());
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
        for (std::uint32_t type = 1; type <= 3; ++type) {
            const DynamicType& all = *built_in.find(type_id(type));
            compare_everywhere(built_in, RandomContent{seed}.structure(all), seed);
        }
        for (const std::uint32_t type : {types::Part, types::Measurement, types::Shape, types::Tree,
                                         types::Container, types::Choice}) {
            const DynamicType& each = *plant().find(type_id(type));
            compare_everywhere(plant(), RandomContent{seed}.structure(each), seed);
        }
    }
}

TEST_CASE("what a structure holds encoded is checked with it", "[binary][dynamic]")
{
    const DynamicValue container = full_container();
    auto bytes = bytes_of(container);
    REQUIRE(check_dynamic(object_of(container.type(), bytes), plant()) == status::Good);
    std::size_t refused = 0;
    for (std::byte& byte : bytes) {
        const std::byte kept = std::exchange(byte, std::byte{0xFE});
        const StatusCode check = check_dynamic(object_of(container.type(), bytes), plant());
        CHECK((check.is_bad() || decoded(container.type(), bytes) == status::Good));
        refused += check.is_bad() && decoded(container.type(), bytes).is_good() ? 1U : 0U;
        byte = kept;
    }
    CHECK(refused > 0);

    DynamicValue part = make(types::Part);
    const NodeId encoding = encoding_of(types::Point);
    const Variant bad{ExtensionObject::from_binary(encoding, {})};
    for (const Variant& held : {bad, Variant{DataValue{bad}}, Variant{Array<Variant>{bad}},
                                Variant{Array<DataValue>{DataValue{bad}}}}) {
        CHECK(check_dynamic(held, plant()) == status::Bad_DecodingError);
        REQUIRE(part.set("Anything", held));
        CHECK(check_dynamic(Variant{to_extension_object(part).value()}, plant()) ==
              status::Bad_DecodingError);
    }
}

TEST_CASE("levels count through encoded structures (Part 6, 5.1.5)", "[binary][dynamic]")
{
    DynamicValue tree = make(types::Tree);
    const auto nest = [&](int levels) {
        for (int i = 0; i < levels; ++i) {
            DynamicArray children{{std::move(tree)}, {}};
            tree = make(types::Tree);
            REQUIRE(tree.set("Children", std::move(children)));
        }
    };
    nest(59); // 60 levels
    DynamicValue container = make(types::Container);
    REQUIRE(container.set("Any", tree));
    const auto in_containers = [&](int count) {
        DynamicValue outer = container;
        for (int i = 1; i < count; ++i) {
            DynamicValue next = make(types::Container);
            REQUIRE(next.set("Any", std::move(outer)));
            outer = std::move(next);
        }
        return check_dynamic(Variant{to_extension_object(outer).value()}, plant());
    };
    CHECK(in_containers(41) == status::Good); // a hundred of them within the outermost
    CHECK(in_containers(42) == status::Bad_EncodingLimitsExceeded);
}

TEST_CASE("checking takes no memory", "[binary][dynamic]")
{
    const DynamicTypes built_in = built_in_types();
    std::vector<Variant> values;
    for (std::uint32_t type = 1; type <= 3; ++type) {
        const DynamicType& all = *built_in.find(type_id(type));
        values.push_back(object_of(all, bytes_of(RandomContent{7}.structure(all))));
    }
    std::size_t before = allocation_count();
    for (const Variant& value : values) {
        REQUIRE(check_dynamic(value, built_in) == status::Good);
    }
    CHECK(allocation_count() == before);

    DynamicArray points;
    for (int i = 0; i < 10'000; ++i) {
        points.values.push_back(point(i, i));
    }
    DynamicValue part = full_part();
    REQUIRE(part.set("Corners", std::move(points)));
    DynamicValue container = full_container();
    REQUIRE(container.set("Any", part));
    const Variant large{to_extension_object(container).value()};
    before = allocation_count();
    const StatusCode found = check_dynamic(large, plant());
    CHECK(allocation_count() == before);
    CHECK(found == status::Good);
}

TEST_CASE("fields may limit texts and dimensions (Part 3, 8.51)", "[binary][dynamic]")
{
    const DynamicTypes types = limited_types();
    REQUIRE(types.errors().empty());
    const auto check = [&](const char* name, Variant content) {
        DynamicValue value{*types.find(type_id(1))};
        REQUIRE(value.set(name, std::move(content)));
        const ExtensionObject object = to_extension_object(value).value();
        CHECK(decode_dynamic(object, types) == value); // a server may send what it likes
        const StatusCode alone = check_dynamic(Variant{object}, types);
        DynamicValue outer{*types.find(type_id(2))};
        REQUIRE(outer.set("Parts", DynamicArray{{value}, {}}));
        CHECK(check_dynamic(Variant{to_extension_object(outer).value()}, types) == alone);
        outer = DynamicValue{outer.type()};
        REQUIRE(outer.set("Any", Variant{Array<ExtensionObject>{object}}));
        CHECK(check_dynamic(Variant{to_extension_object(outer).value()}, types) == alone);
        return alone;
    };
    const auto matrix = [](std::uint32_t rows, std::uint32_t columns) {
        Array<std::int32_t> numbers;
        numbers.resize(std::size_t{rows} * columns);
        return Variant::matrix(std::move(numbers), {rows, columns});
    };
    CHECK(check("Name", Variant{"four"}) == status::Good);
    CHECK(check("Name", Variant{String{}}) == status::Good);
    CHECK(check("Name", Variant{"fives"}) == status::Bad_OutOfRange);
    CHECK(check("Name", Variant{"\xC3\xA9\xC3\xA9"}) == status::Good); // bytes, not characters
    CHECK(check("Name", Variant{"\xC3\xA9\xC3\xA9\xC3\xA9"}) == status::Bad_OutOfRange);
    const std::vector<std::byte> bytes(5);
    CHECK(check("Raw", Variant{ByteString{std::span{bytes}.first(4)}}) == status::Good);
    CHECK(check("Raw", Variant{ByteString{std::span{bytes}}}) == status::Bad_OutOfRange);
    CHECK(check("Title", Variant{LocalizedText{"en-GB", "four"}}) == status::Good);
    CHECK(check("Title", Variant{LocalizedText{"en", "fives"}}) == status::Bad_OutOfRange);
    CHECK(check("Names", Variant{Array<String>{"abc", "de"}}) == status::Good);
    CHECK(check("Names", Variant{Array<String>{"abcd"}}) == status::Bad_OutOfRange);
    CHECK(check("Names", Variant{Array<String>{"a", "b", "c"}}) == status::Bad_OutOfRange);
    CHECK(check("Matrix", matrix(2, 9)) == status::Good);
    CHECK(check("Matrix", matrix(3, 1)) == status::Bad_OutOfRange);
    CHECK(check("Numbers", Variant{Array<std::int32_t>{1, 2, 3, 4, 5}}) == status::Good);
}

} // namespace dynamic_check_test
