#include <catch2/catch.hpp>

#include <cmath>
#include <iterator>
#include <limits>

#include <busbar/core/types.hpp>

namespace value_test {

using namespace busbar;

namespace {

/// One scalar of each kind of storage: inline number, inline text, boxed.
std::vector<Variant> samples()
{
    std::vector<Variant> values;
    values.emplace_back();
    values.emplace_back(std::int32_t{-5});
    values.emplace_back(Guid{1, 2, 3, {}});
    values.emplace_back("a text that needs memory of its own");
    values.emplace_back(LocalizedText{"en", "text"});
    values.emplace_back(NodeId{2, "id"});
    values.emplace_back(Array<double>{1.5, 2.5});
    values.emplace_back(Array<String>{"a", String{}});
    values.emplace_back(Array<double>{});
    values.push_back(Variant::matrix(Array<std::int32_t>{1, 2, 3, 4}, {2, 2}));
    values.emplace_back(Array<Variant>{Variant{1}, Variant{"x"}});
    values.emplace_back(DataValue{Variant{7}, status::Bad_Timeout, DateTime{5}});
    return values;
}

} // namespace

TEST_CASE("a Variant is copied and moved as a value", "[core][variant]")
{
    const auto values = samples();
    for (std::size_t i = 0; i < values.size(); ++i) {
        for (std::size_t j = 0; j < values.size(); ++j) {
            Variant target = values[i];
            CHECK((target == values[j]) == (i == j));
            target = values[j];
            CHECK(target == values[j]);
            Variant taken = std::move(target);
            CHECK(taken == values[j]);
            target = values[i];
            taken = std::move(target);
            CHECK(taken == values[i]);
        }
    }
}

TEST_CASE("a Variant may be assigned a part of itself", "[core][variant]")
{
    Variant outer{Array<Variant>{Variant{"inner text of some length"}, Variant{2}}};
    outer = Variant{(*outer.array_if<Variant>())[0]};
    CHECK(outer == Variant{"inner text of some length"});
    Variant list{Array<Variant>{Variant{"moved text of some length"}}};
    list = std::move((*list.array_if<Variant>())[0]);
    CHECK(list == Variant{"moved text of some length"});
}

TEST_CASE("a Variant tells type, kind and dimensions", "[core][variant]")
{
    const Variant grid = Variant::matrix(Array<std::uint8_t>{1, 2, 3, 4, 5, 6}, {2, 3});
    CHECK(grid.is_matrix());
    CHECK(grid.array_size() == 6);
    CHECK(grid.dimensions()[1] == 3);
    CHECK(grid.type() == BuiltInType::Byte);
    CHECK(grid.get_if<std::uint8_t>() == nullptr);
    CHECK(grid.array_if<std::int8_t>() == nullptr);
    const Variant scalar{2.5F};
    CHECK(scalar.value_or(0.0F) == 2.5F);
    CHECK(scalar.value_or(1.0) == 1.0);
    CHECK(Variant{}.type() == BuiltInType::Null);
    CHECK_FALSE(Variant::matrix(Array<std::uint8_t>{1}, {1}).is_matrix());
    CHECK(name(BuiltInType::ExpandedNodeId) == "ExpandedNodeId");
}

TEST_CASE("NaN equals NaN in a Variant", "[core][variant]")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(Variant{nan} == Variant{nan});
    CHECK(Variant{Array<double>{nan, 1.0}} == Variant{Array<double>{nan, 1.0}});
    CHECK_FALSE(Variant{nan} == Variant{1.0});
}

TEST_CASE("an Array is null until it is given a size", "[core][array]")
{
    Array<std::int32_t> values;
    CHECK(values.is_null());
    CHECK(values != Array<std::int32_t>{std::size_t{0}});
    values.clear();
    CHECK_FALSE(values.is_null());
    for (int i = 0; i < 100; ++i) {
        values.push_back(i);
    }
    CHECK(values.size() == 100);
    values.push_back(values.front());
    CHECK(values.back() == 0);
    values.resize(3);
    CHECK(values == Array<std::int32_t>{0, 1, 2});
    const Array<std::int32_t> copy = values;
    values.reset();
    CHECK(values.is_null());
    CHECK(copy.size() == 3);
}

TEST_CASE("a growing Array takes an element of its own", "[core][array]")
{
    Array<String> texts{"one that is not kept inline anywhere"};
    for (int i = 0; i < 20; ++i) {
        texts.push_back(texts[0]);
    }
    CHECK(texts.back() == texts.front());
}

TEST_CASE("an Array is assigned so many copies of a value", "[core][array]")
{
    Array<String> texts{"one that is not kept inline anywhere", "b", "c"};
    texts.assign(20, texts[0]);
    CHECK(texts.size() == 20);
    CHECK(texts[19] == String{"one that is not kept inline anywhere"});
    texts.assign(2, "b");
    CHECK(texts == Array<String>{"b", "b"});
    Array<std::int32_t> numbers;
    numbers.assign(3, 4); // and not the elements from 3 to 4
    CHECK(numbers == Array<std::int32_t>{4, 4, 4});
    Array<std::size_t> none;
    none.assign(0, 7);
    CHECK((none.empty() && !none.is_null()));
    const std::int32_t more[] = {5, 6};
    numbers.assign(std::begin(more), std::end(more));
    CHECK(numbers == Array<std::int32_t>{5, 6});
}

TEST_CASE("an Array of Variants is assigned, not wrapped", "[core][array]")
{
    const Array<Variant> values{Variant{1}, Variant{2}};
    Array<Variant> copy;
    copy = values;
    CHECK(copy.size() == 2);
    Array<Variant> moved;
    moved = std::move(copy);
    CHECK(moved == values);
}

TEST_CASE("an ExtensionObject of an unknown type keeps its bytes", "[core][extension_object]")
{
    const std::byte bytes[] = {std::byte{1}, std::byte{2}};
    const auto object = ExtensionObject::from_binary(NodeId{3, 77}, ByteString{bytes});
    const ExtensionObject copy = object;
    CHECK(copy == object);
    CHECK(copy.binary().size() == 2);
    CHECK_FALSE(copy.is_null());
    CHECK(ExtensionObject{}.is_null());
    CHECK_FALSE(copy == ExtensionObject::from_id(NodeId{3, 77}));
}

TEST_CASE("DiagnosticInfo is compared to its depth", "[core][diagnostic_info]")
{
    DiagnosticInfo info;
    CHECK(info.is_null());
    info.symbolic_id = 1;
    info.inner_diagnostic_info = std::make_unique<DiagnosticInfo>();
    info.inner_diagnostic_info->additional_info = String{"why"};
    DiagnosticInfo copy = info;
    CHECK(copy == info);
    copy.inner_diagnostic_info->additional_info = String{"not"};
    CHECK_FALSE(copy == info);
    CHECK_FALSE(info.is_null());
}

} // namespace value_test
