#include <catch2/catch.hpp>

#include "program_parts.hpp"

namespace publishing_rules_test {

using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

/// Why the only variable, of this type, is not published; "" if it is.
std::string reason_against(std::vector<DerivedType> types, TypeUse type,
                           PublishingLimits limits = nj501_publishing())
{
    const Published published{{.types = std::move(types), .variables = {variable("x", type)}},
                              limits};
    const auto& unpublished = published.publication.unpublished();
    CHECK(published.publication.exceeded().none());
    CHECK(unpublished.size() + published.publication.published().size() == 1);
    CHECK(published.publication.status_bits() == (unpublished.empty() ? 0 : 8));
    return unpublished.empty() ? "" : std::string{name(unpublished[0].reason)};
}

std::vector<TypeUse> many(std::size_t count, const TypeUse& type)
{
    return std::vector<TypeUse>(count, type);
}

const TypeUse an_int = use(ElementaryType::Int);

} // namespace

TEST_CASE("Members that are structures do not count below (6-2-2, *3)")
{
    const std::vector<DerivedType> types{structure("In", many(101, use(ElementaryType::Bool))),
                                         structure("Out", {use("In"), an_int}),
                                         structure("Full", many(100, an_int)),
                                         structure("Over", many(101, an_int))};
    CHECK(reason_against(types, use("Out")) == "");
    CHECK(reason_against(types, use("Full")) == "");
    CHECK(reason_against(types, use("Over")) == "MaxMembers");
    CHECK(reason_against(types, array_of(use("Over"), {{0, 1}})) == "MaxMembers");

    const Published published{{.types = types, .variables = {variable("x", use("Out"))}}};
    CHECK(published.publication.published().at(0).members == 2);
}

TEST_CASE("Arrays of structures have one dimension (6-2-2, *4)")
{
    const auto types = tower(1);
    CHECK(reason_against(types, array_of(use("T1"), {{0, 1}})) == "");
    CHECK(reason_against(types, array_of(use("T1"), {{0, 1}, {0, 1}})) == "MultiDimensionalArray");
    CHECK(reason_against({}, array_of(an_int, {{0, 1}, {0, 1}})) == "");
    CHECK(reason_against(types, array_of(use("T1"), {{0, 1}, {0, 1}}), {}) == "");
    CHECK(event_bit(UnpublishedReason::MatrixOfStructures) == 1);
}

TEST_CASE("Members of structures have one dimension (6-2-2, *5)")
{
    const std::vector<DerivedType> types{
        structure("In", {array_of(use(ElementaryType::Bool), {{0, 1}, {0, 1}})}),
        structure("Out", {an_int, use("In")}), structure("Ok", {array_of(an_int, {{0, 1}})})};
    CHECK(reason_against(types, use("In")) == "MultiDimensionalArray");
    CHECK(reason_against(types, use("Out")) == "MultiDimensionalArray");
    CHECK(reason_against(types, use("Ok")) == "");
    CHECK(event_bit(UnpublishedReason::MatrixInStructure) == 2);
}

TEST_CASE("Array types within array types are dimensions, too (6-2-2, *5)")
{
    const std::vector<DerivedType> types{
        {.name = "Row", .kind = DerivedType::Kind::Alias, .alias = array_of(an_int, {{0, 1}})},
        structure("Grid", {array_of(use("Row"), {{0, 1}})})};
    CHECK(reason_against(types, use("Grid")) == "MultiDimensionalArray");
}

TEST_CASE("Structures have three levels (6-2-2)")
{
    CHECK(reason_against(tower(3), use("T3")) == "");
    CHECK(reason_against(tower(4), use("T4")) == "NestedStructre");
    CHECK(reason_against(tower(4), use("T4"), {}) == "");
    CHECK(event_bit(UnpublishedReason::NestedStructure) == 4);
}

TEST_CASE("Unions are not published, nor what has one (6-2-2)")
{
    const std::vector<DerivedType> types{union_of("Either", {an_int, use(ElementaryType::Real)}),
                                         structure("Has", {array_of(use("Either"), {{0, 1}})})};
    CHECK(reason_against(types, use("Either")) == "Union");
    CHECK(reason_against(types, use("Has")) == "Union");
    CHECK(reason_against(types, use("Has"), {}) == "");
    CHECK(event_bit(UnpublishedReason::Union) == 8);
}

TEST_CASE("Arrays begin with 0, also within structures (6-2-2)")
{
    const std::vector<DerivedType> types{structure("Has", {array_of(an_int, {{1, 2}})}),
                                         structure("Out", {use("Has")})};
    CHECK(reason_against({}, array_of(an_int, {{2, 5}})) == "SubscriptOfArray");
    CHECK(reason_against({}, array_of(an_int, {{0, 5}, {1, 2}})) == "SubscriptOfArray");
    CHECK(reason_against({}, array_of(an_int, {{-1, 1}})) == "SubscriptOfArray");
    CHECK(reason_against(types, use("Out")) == "SubscriptOfArray");
    CHECK(reason_against(types, use("Out"), {}) == "");
    CHECK(event_bit(UnpublishedReason::FirstIndex) == 16);
}

TEST_CASE("A variable has 1,024 elements (6-2-2)")
{
    const TypeUse a_bool = use(ElementaryType::Bool);
    CHECK(reason_against({}, array_of(a_bool, {{0, 1023}})) == "");
    CHECK(reason_against({}, array_of(a_bool, {{0, 31}, {0, 31}})) == "");
    CHECK(reason_against({}, array_of(a_bool, {{0, 1024}})) == "MaxArrayElements");
    CHECK(reason_against({}, array_of(a_bool, {{0, 31}, {0, 32}})) == "MaxArrayElements");
    CHECK(reason_against({}, array_of(a_bool, {{0, 1024}}), {}) == "");
    CHECK(event_bit(UnpublishedReason::MaxArrayElements) == 64);
    CHECK(event_bit(UnpublishedReason::MaxMembers) == 128);
}

TEST_CASE("A variable has 1,024 bytes (6-2-2)")
{
    CHECK(reason_against({}, array_of(an_int, {{0, 511}})) == "");
    CHECK(reason_against({}, array_of(an_int, {{0, 512}})) == "MaxSize");
    CHECK(reason_against({}, {.elementary = ElementaryType::String, .string_length = 1023}) == "");
    CHECK(reason_against({}, {.elementary = ElementaryType::String, .string_length = 1024}) ==
          "MaxSize");
    const Published published{{.variables = {variable("x", array_of(an_int, {{0, 512}}))}}};
    CHECK(published.publication.unpublished().at(0).size == 1026);
    // As the CPU counts them: members at multiples of their size, BOOL arrays in bits.
    const std::vector<DerivedType> types{
        structure("S", {use(ElementaryType::Bool), use(ElementaryType::Lreal)})};
    CHECK(reason_against(types, array_of(use("S"), {{0, 63}})) == "");
    CHECK(reason_against(types, array_of(use("S"), {{0, 64}})) == "MaxSize");
    CHECK(reason_against({}, array_of(use(ElementaryType::Bool), {{0, 1023}})) == "");
    CHECK(event_bit(UnpublishedReason::MaxSize) == 32);
}

TEST_CASE("The first reason is the one that is told (7-1-6, 0101)")
{
    // All rules at once; each reason hides those behind it.
    std::vector<DerivedType> types = tower(4);
    std::vector<TypeUse> members = many(101, an_int);
    members.push_back(use("T4"));
    members.push_back(use("Either"));
    members.push_back(array_of(an_int, {{1, 1}, {0, 0}}));
    types.push_back(union_of("Either", {an_int}));
    types.push_back(structure("All", members));
    PublishingLimits limits = nj501_publishing();
    limits.max_values.reset(); // which would be looked at before
    const auto reason = [&] {
        types.back().members.resize(members.size());
        return reason_against(types, array_of(use("All"), {{0, 1024}}), limits);
    };
    CHECK(reason() == "MultiDimensionalArray");
    members.pop_back();
    CHECK(reason() == "NestedStructre");
    types.back().members[101].type = use("T1");
    CHECK(reason() == "Union");
    types.back().members[102].type = array_of(an_int, {{1, 1}});
    CHECK(reason() == "SubscriptOfArray");
    members.pop_back();
    CHECK(reason() == "MaxArrayElements");
    CHECK(reason_against(types, use("All")) == "MaxMembers");
}

} // namespace publishing_rules_test
