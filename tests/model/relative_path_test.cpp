#include <catch2/catch.hpp>

#include <busbar/model/relative_path.hpp>

#include "model_fixture.hpp"

namespace busbar::model::relative_path_test {

namespace {

struct PathFixture : ModelFixture {
    PathFixture()
    {
        NewNode node = named("ConnectedTo", space.find(id::NonHierarchicalReferences));
        REQUIRE(space.add_reference_type(node, {}));
    }
    [[nodiscard]] RelativePath parsed(std::string_view text) const
    {
        const auto path = parse_relative_path(text, space);
        INFO(text);
        REQUIRE(path);
        CHECK(to_text(*path, space) == std::string{text});
        return *path;
    }
    [[nodiscard]] StatusCode refusal(std::string_view text) const
    {
        return status_of(parse_relative_path(text, space));
    }
    [[nodiscard]] RelativePathElement step(NodeId type, QualifiedName name) const
    {
        return {std::move(type), false, true, std::move(name)};
    }
};

} // namespace

TEST_CASE_METHOD(PathFixture, "The examples of Part 4, A.2 are read and written (Table A.2)")
{
    const NodeId connected_to{ns, "ConnectedTo"};
    const NodeId any{0, id::HierarchicalReferences};
    const NodeId child{0, id::HasChild};
    REQUIRE(ns == 1);
    CHECK(parsed("/2:Block&.Output") == RelativePath{{step(any, {2, "Block.Output"})}});
    CHECK(parsed("/3:Truck.NodeVersion") ==
          RelativePath{
              {step(any, {3, "Truck"}), step(NodeId{0, id::Aggregates}, {0, "NodeVersion"})}});
    CHECK(parse_relative_path("/3:Truck.0:NodeVersion", space) == parsed("/3:Truck.NodeVersion"));
    CHECK(parsed("<1:ConnectedTo>1:Boiler/1:HeatSensor") ==
          RelativePath{{step(connected_to, {1, "Boiler"}), step(any, {1, "HeatSensor"})}});
    CHECK(parsed("<1:ConnectedTo>1:Boiler/") ==
          RelativePath{{step(connected_to, {1, "Boiler"}), step(any, {})}});
    CHECK(parse_relative_path("<0:HasChild>2:Wheel", space) ==
          RelativePath{{step(child, {2, "Wheel"})}});
    RelativePathElement inverse = step(child, {0, "Truck"});
    inverse.is_inverse = true;
    CHECK(parsed("<!HasChild>Truck") == RelativePath{{inverse}});
    CHECK(parsed("<HasChild>") == RelativePath{{step(child, {})}});
}

TEST_CASE_METHOD(PathFixture, "Every production of the BNF is read and written (Part 4, A.2)")
{
    // reserved-char: in a name each stands behind an '&', and means something of its own without.
    for (const char reserved : std::string_view{"/.<>:#!&"}) {
        const std::string name{'a', reserved, 'b'};
        INFO(name);
        const std::string text{'/', 'a', '&', reserved, 'b'};
        CHECK(parsed(text).elements[0].target_name == QualifiedName{0, name});
        const auto plain = parse_relative_path("/" + name, space);
        CHECK((!plain || plain->elements.size() == 2));
        const RelativePath in_type = parsed("<1:ConnectedTo>1:" + text.substr(1));
        CHECK(in_type.elements[0].target_name == QualifiedName{1, name});
    }
    // reference-type: with '#', '!' or both, with a namespace index or without.
    for (const char* const flags : {"", "#", "!", "#!"}) {
        for (const char* const type : {"1:ConnectedTo", "HasComponent"}) {
            const RelativePath path = parsed("<" + std::string{flags} + type + ">x");
            CHECK(path.elements[0].include_subtypes ==
                  (std::string_view{flags}.find('#') == std::string_view::npos));
            CHECK(path.elements[0].is_inverse ==
                  (std::string_view{flags}.find('!') != std::string_view::npos));
        }
    }
    // browse-path: any number of elements, of which the last may go without a name.
    CHECK(parsed("/a.b<HasChild>c/d.1:e.f/").elements.size() == 7);
}

TEST_CASE_METHOD(PathFixture, "Paths may exclude subtypes and have any name")
{
    const RelativePath path = parsed("<#!HasComponent>2:&#&!&&&:&<&>&/x y");
    const RelativePathElement& element = path.elements[0];
    CHECK_FALSE(element.include_subtypes);
    CHECK(element.is_inverse);
    CHECK(element.target_name == QualifiedName{2, "#!&:<>/x y"});
    CHECK(parsed("/12").elements[0].target_name == QualifiedName{0, "12"});
    CHECK(parsed("/12&:x").elements[0].target_name == QualifiedName{0, "12:x"});
    CHECK(parsed("/65535:x").elements[0].target_name.namespace_index == 65'535);
    // The general form of what has a sign of its own.
    CHECK(parse_relative_path("<Aggregates>x", space) == parsed(".x"));
    CHECK(parsed("<#HierarchicalReferences>x").elements[0].include_subtypes == false);
}

TEST_CASE_METHOD(PathFixture, "Text that is no relative path is refused")
{
    for (const char* text :
         {"", "x", "//x", "/x//y", "/a&b", "/a&", "<", "<>", "<>x", "<HasChild", "<!#HasChild>x",
          "/1:", "/a:b", "/70000:x", "/x>", "/a#b", "/2:3:x", "<0:>x", "<HasChild>><"}) {
        INFO(text);
        CHECK(refusal(text) == status::Bad_SyntaxError);
    }
    CHECK(refusal("<HasNone>x") == status::Bad_ReferenceTypeIdInvalid);
    CHECK(refusal("<2:HasChild>x") == status::Bad_ReferenceTypeIdInvalid);
    CHECK(refusal("<ObjectsFolder>x") == status::Bad_ReferenceTypeIdInvalid);
}

TEST_CASE_METHOD(PathFixture, "A relative path without a text says why")
{
    const NodeId any{0, id::HierarchicalReferences};
    CHECK(status_of(to_text(RelativePath{{step({}, {0, "x"})}}, space)) ==
          status::Bad_ReferenceTypeIdInvalid);
    CHECK(status_of(to_text(RelativePath{{step(NodeId{0, id::ObjectsFolder}, {0, "x"})}}, space)) ==
          status::Bad_ReferenceTypeIdInvalid);
    CHECK(status_of(to_text(RelativePath{{step(any, {}), step(any, {0, "x"})}}, space)) ==
          status::Bad_BrowseNameInvalid);
    CHECK(status_of(to_text(RelativePath{{step(any, {1, ""})}}, space)) ==
          status::Bad_BrowseNameInvalid);
}

} // namespace busbar::model::relative_path_test
