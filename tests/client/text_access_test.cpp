#include <catch2/catch.hpp>

#include <busbar/client/attributes.hpp>
#include <busbar/client/text_access.hpp>
#include <busbar/model/data_types.hpp>

#include "server/method_fixture.hpp"
#include "server_requester.hpp"

namespace busbar::client::text_access_test {

namespace {

/// A machine with Variables of its own types, and a client who knows nothing of them.
struct Machine : test::MethodFixture {
    Machine()
    {
        EnumDefinition modes;
        for (const char* const name : {"Off", "Manual", "Auto"}) {
            EnumField& field = modes.fields.emplace_back();
            field.value = static_cast<std::int64_t>(modes.fields.size()) - 1;
            field.name = name;
        }
        REQUIRE(model::add_enumeration_type(space(), named("Mode", space().find(id::Enumeration)),
                                            modes));
        StructureDefinition point;
        for (const char* const name : {"X", "Mode"}) {
            StructureField& field = point.fields.emplace_back();
            field.name = name;
            field.data_type = point.fields.size() == 1 ? NodeId{0, id::Double} : own("Mode");
            field.value_rank = -1;
        }
        REQUIRE(
            model::add_structure_type(space(), named("Point", space().find(id::Structure)), point));
        add_value("Number", NodeId{0, id::Byte}, Variant{std::uint8_t{1}});
        add_value("State", own("Mode"), Variant{0});
        add_value("Place", own("Point"), Variant{});
        add_value("List", NodeId{0, id::Int32}, Variant{Array<std::int32_t>{}}, 1);
    }
    void add_value(const char* name, const NodeId& type, Variant value, std::int32_t rank = -1)
    {
        model::NewVariable variable;
        variable.data_type = type;
        variable.value_rank = rank;
        variable.access_level = model::Access::ReadWrite;
        variable.value = std::move(value);
        REQUIRE(space().add_variable(named(name, machine), variable));
    }

    test::ServerRequester& requester()
    {
        if (!requester_) {
            requester_ = std::make_unique<test::ServerRequester>(log_in());
        }
        return *requester_;
    }
    TypeCache& types()
    {
        if (!types_) {
            types_ = std::make_unique<TypeCache>(requester());
        }
        return *types_;
    }
    /// "" or the error.
    std::string written(const char* name, const char* text)
    {
        std::string error = "not done";
        write_text(requester(), types(), at(name), text, [&](const Accessed<void>& result) {
            error = result ? ""
                           : std::string{busbar::name(result.error().status)} + ": " +
                                 result.error().message;
        });
        requester_->run();
        return error;
    }
    std::string read_text(const char* name)
    {
        std::string text;
        client::read(requester(), {at(name)}, [&](const std::vector<DataValue>& values) {
            types().learn_values({values.front().value}, [&, value = values.front().value] {
                const auto known = types().types();
                text = to_text(value, TextOptions{known.get(), nullptr, {}});
            });
        });
        requester_->run();
        return text;
    }
    std::string called(const char* method, std::vector<std::string> arguments)
    {
        std::string text = "not done";
        call_text(requester(), types(), at(nullptr), at(method), std::move(arguments),
                  [&](const Accessed<CallMethodResult>& result) {
                      text = result ? to_text(Variant{result->output_arguments})
                                    : std::string{busbar::name(result.error().status)} + ": " +
                                          result.error().message;
                  });
        requester_->run();
        return text;
    }
    static NodeAddress at(const char* name)
    {
        const std::string path = "/Objects/1:Machine";
        return NodeAddress::parse(name == nullptr ? path : path + "/1:" + name).value();
    }

private:
    std::unique_ptr<test::ServerRequester> requester_;
    std::unique_ptr<TypeCache> types_;
};

} // namespace

TEST_CASE_METHOD(Machine, "Texts are written as what the Variable's DataType says",
                 "[unit:Attribute Client Write Complex][unit:Attribute Client Write Base]")
{
    CHECK(written("Number", "200").empty());
    CHECK(read_text("Number") == "200");
    CHECK(written("Number", "300") ==
          "Bad_TypeMismatch: value: expected a Byte, 0 to 255, found \"300\"");
    CHECK(written("State", "Auto").empty());
    CHECK(read_text("State") == "2");
    CHECK(written("List", "[1, 2]").empty());
    CHECK(read_text("List") == "[1, 2]");
    CHECK(written("List", "1").starts_with("Bad_TypeMismatch: value: expected a list"));
    CHECK(written("Place", R"({"X": 1.5, "Mode": "Manual"})").empty());
    CHECK(read_text("Place") == "Point {X: 1.5, Mode: Manual (1)}");
    CHECK(written("None", "1") == "Bad_NoMatch: the address names no node");
}

TEST_CASE_METHOD(Machine, "Methods are called with a text for each argument")
{
    add_sum();
    add_taking("Go", Argument{"how", own("Mode"), -1, {}, {}});
    CHECK(called("Sum", {"2", "3"}) == "[5]");
    CHECK(called("Sum", {"2"}) == "Bad_ArgumentsMissing: the method has 2 arguments, not 1");
    CHECK(
        called("Sum", {"2", "x"}).starts_with("Bad_InvalidArgument: argument: expected an Int32"));
    CHECK(called("Go", {"Auto"}) == "null");
    CHECK(
        called("Go", {"Fast"}).starts_with("Bad_InvalidArgument: how: expected a number or name"));
    CHECK(called("None", {}) == "Bad_NoMatch: the method's address names no node");
}

TEST_CASE_METHOD(Machine, "A cancelled write is not done")
{
    bool is_done = false;
    Operation operation = write_text(requester(), types(), at("Number"), "5",
                                     [&](const Accessed<void>&) { is_done = true; });
    CHECK(operation.is_under_way());
    operation.cancel();
    requester().run();
    CHECK_FALSE(is_done);
    CHECK(read_text("Number") == "1");
}

} // namespace busbar::client::text_access_test
