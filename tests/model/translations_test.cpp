#include <catch2/catch.hpp>

#include <busbar/model/address_space.hpp>
#include <busbar/types/ids.hpp>

namespace translations_test {

using namespace busbar;
using namespace busbar::model;

namespace {

using Texts = std::vector<LocalizedText>;

struct Oven {
    Oven()
    {
        NewNode oven;
        oven.id = NodeId{1, "Oven"};
        oven.browse_name = QualifiedName{1, "Oven"};
        oven.parent = space.find(id::ObjectsFolder);
        static_cast<void>(space.add_namespace("urn:test"));
        NewVariable variable;
        variable.data_type = NodeId{0, id::LocalizedText};
        node = space.add_variable(oven, variable).value();
    }
    StatusCode set(AttributeId attribute, const char* locale, const char* text)
    {
        const auto done =
            space.set_text(node, attribute, Variant{LocalizedText{String{locale}, String{text}}});
        return done ? status::Good : done.error();
    }
    [[nodiscard]] LocalizedText name_in(std::vector<std::string> locales) const
    {
        LocalizedText text = space.display_name(node);
        space.translate(node, AttributeId::DisplayName, locales, text);
        return text;
    }
    [[nodiscard]] Texts texts(AttributeId attribute) const { return space.texts(node, attribute); }

    AddressSpace space;
    NodeIndex node{no_node};
};

constexpr auto name = AttributeId::DisplayName;

} // namespace

TEST_CASE_METHOD(Oven, "an attribute has a text for each locale (Part 4, 5.11.4.1)")
{
    CHECK(texts(name) == Texts{LocalizedText{"Oven"}});
    REQUIRE(set(name, "de", "Ofen") == status::Good);
    REQUIRE(set(name, "de-AT", "Rohr") == status::Good);
    REQUIRE(set(name, "", "Furnace") == status::Good);
    CHECK(texts(name) == Texts{LocalizedText{"Furnace"}, {"de", "Ofen"}, {"de-AT", "Rohr"}});
    REQUIRE(set(name, "DE", "Backofen") == status::Good);
    CHECK(texts(name)[1].text == "Backofen");

    // An empty text ends that of its locale; the next is first then.
    REQUIRE(set(name, "de-AT", "") == status::Good);
    REQUIRE(set(name, "fr", "") == status::Good);
    REQUIRE(set(name, "", "x") == status::Good);
    CHECK(texts(name) == Texts{LocalizedText{"x"}, {"DE", "Backofen"}});
    // Neither locale nor text: all of them.
    REQUIRE(set(name, "", "") == status::Good);
    CHECK(texts(name) == Texts{LocalizedText{"Oven"}}); // the BrowseName stands for it
    CHECK_FALSE(space.has_further_texts(node));

    REQUIRE(set(AttributeId::Description, "en", "hot") == status::Good);
    REQUIRE(set(AttributeId::Description, "de", "heiss") == status::Good);
    REQUIRE(set(AttributeId::Description, "en", "") == status::Good);
    CHECK(texts(AttributeId::Description) == Texts{{"de", "heiss"}});
    CHECK(set(AttributeId::BrowseName, "en", "x") == status::Bad_AttributeIdInvalid);
    CHECK(set(AttributeId::InverseName, "en", "x") == status::Bad_AttributeIdInvalid);
    CHECK(space.set_text(node, name, Variant{1}).error() == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(Oven, "the locale that fits best is told (Part 4, 5.4 and 5.7.3)")
{
    REQUIRE(set(name, "de", "Ofen") == status::Good);
    REQUIRE(set(name, "pt-BR", "Forno") == status::Good);
    REQUIRE(set(name, "pt", "Fornalha") == status::Good);
    CHECK(name_in({}).text == "Oven");
    CHECK(name_in({"en"}).text == "Oven");
    CHECK(name_in({"", "de"}) == LocalizedText{"de", "Ofen"});
    CHECK(name_in({"pt", "de"}).text == "Fornalha");
    CHECK(name_in({"PT-br"}).text == "Forno");
    // All locales as they are before any language alone.
    CHECK(name_in({"pt-PT", "de"}).text == "Ofen");
    CHECK(name_in({"de-CH", "pt-PT"}).text == "Ofen");
    CHECK(name_in({"d", "d-DE", "-", "deu"}).text == "Oven");
}

TEST_CASE_METHOD(Oven, "a value that is a text has locales, and is new as a whole")
{
    constexpr auto value = AttributeId::Value;
    CHECK(set(value, "en", "on") == status::Good);
    DataValue german{Variant{LocalizedText{"de", "an"}}, status::Uncertain};
    german.source_timestamp = DateTime::from_unix_seconds(5);
    CHECK(space.set_text(node, value, german));
    CHECK(texts(value) == Texts{{"en", "on"}, {"de", "an"}});
    CHECK(space.data_value(node).status == status::Uncertain);
    CHECK(space.data_value(node).source_timestamp == german.source_timestamp);
    REQUIRE(set(name, "de", "Ofen") == status::Good);
    REQUIRE(space.set_value(node, Variant{LocalizedText{"off"}}));
    CHECK(texts(value) == Texts{LocalizedText{"off"}});
    CHECK(texts(name).size() == 2);

    NewNode number;
    number.id = NodeId{1, "Number"};
    number.browse_name = QualifiedName{1, "Number"};
    number.parent = space.find(id::ObjectsFolder);
    NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    node = space.add_variable(number, variable).value();
    CHECK(set(value, "en", "x") == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(Oven, "texts go with their node, and constant nodes have them too")
{
    REQUIRE(set(name, "de", "Ofen") == status::Good);
    const NodeIndex oven = node;
    REQUIRE(space.remove(node));
    NewNode other;
    other.id = NodeId{1, "Other"};
    other.browse_name = QualifiedName{1, "Other"};
    other.parent = space.find(id::ObjectsFolder);
    node = space.add_object(other).value();
    CHECK(node == oven); // its index
    CHECK(texts(name) == Texts{LocalizedText{"Other"}});

    node = space.find(id::ObjectsFolder);
    REQUIRE(set(name, "de", "Objekte") == status::Good);
    CHECK(name_in({"de"}).text == "Objekte");
    space.set_display_name(node, LocalizedText{"Things"});
    CHECK(name_in({"de"}).text == "Things");
    node = space.find(id::Organizes);
    const auto inverse = texts(AttributeId::InverseName).front();
    CHECK(set(AttributeId::InverseName, inverse.locale.str().c_str(), "x") ==
          status::Bad_NotWritable);
    CHECK(set(AttributeId::InverseName, "de", "geordnet von") == status::Good);
    CHECK(texts(AttributeId::InverseName) == Texts{inverse, {"de", "geordnet von"}});
}

} // namespace translations_test
