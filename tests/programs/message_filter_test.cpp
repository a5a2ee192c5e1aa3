#include <catch2/catch.hpp>

#include "tool/connection/failure.hpp"
#include "tool/recordings/message_filter.hpp"

namespace message_filter_test {

using namespace busbar;
using namespace busbar::tool;
using harness::RecordedMessage;

namespace {

/// A response as a recording has it; the request that it answers has asked for `ns=1;s=Oven 1`.
bool is_chosen(const std::string& filter, const std::vector<RecordedMessage::Field>& fields)
{
    INFO(filter);
    MessageFilter chosen{filter};
    RecordedMessage request;
    request.number = 1;
    request.name = "ReadRequest";
    request.request_id = 7;
    request.fields = {{"nodesToRead[0].nodeId", "ns=1;s=Oven 1"}};
    static_cast<void>(chosen.is_wanted(request));
    RecordedMessage response = request;
    response.number = 2;
    response.name = "ReadResponse";
    response.from = harness::Side::Server;
    response.fields = fields;
    return chosen.is_wanted(response);
}

bool is_value(const std::string& condition, const std::string& text)
{
    return is_chosen("value" + condition, {{"value", text}});
}

} // namespace

TEST_CASE("values of a filter are compared as numbers, or as texts without quotes")
{
    CHECK(is_value("=1.5", "Double 1.5"));
    CHECK(is_value("=Double 1.5", "Double 1.50"));
    CHECK(is_value(">9", "UInt16 10"));
    CHECK(is_value("<=-1", "SByte -1"));
    CHECK(is_value("!=2", "Int32 3"));
    CHECK(is_value("=Oven", "String \"Oven\""));
    CHECK(is_value("=\"Oven 1\"", "\"Oven 1\""));
    CHECK(is_value("=String \"Oven\"", "String \"Oven\""));
    CHECK(is_value("~ven", "String \"Oven\""));
    // The number at the end of a text is not the text.
    CHECK_FALSE(is_value("=Tank 1", "String \"Oven 1\""));
    CHECK_FALSE(is_value("=ns=1;s=Tank 1", "ns=1;s=Oven 1"));
}

TEST_CASE("a status of a filter is one, all of a kind, or a part of its name")
{
    const auto has = [](const std::string& condition, const std::string& text) {
        return is_chosen("status" + condition, {{"results[0].statusCode", text}});
    };
    CHECK(has("=Good", "Good_Clamped"));
    CHECK(has("=Bad", "Bad_Timeout"));
    CHECK(has("=Bad_Timeout", "Bad_Timeout"));
    CHECK(has("~Time", "Bad_Timeout"));
    CHECK(has("!=Good", "Uncertain_LastUsableValue"));
    CHECK_FALSE(has("!=Good", "Good_Clamped"));
    CHECK_FALSE(has("~Time", "Good"));
    CHECK_FALSE(has("=Good", "Double 1.5"));
}

TEST_CASE("a node of a filter is one of the request")
{
    CHECK(is_chosen("node=\"ns=1;s=Oven 1\"", {}));
    CHECK(is_chosen("node~Oven", {}));
    CHECK(is_chosen("node!=i=85", {}));
    CHECK_FALSE(is_chosen("node~Tank", {}));
}

TEST_CASE("conditions of a filter are joined by and and or")
{
    CHECK(is_chosen("service=Write or service=Read and from=server", {}));
    CHECK_FALSE(is_chosen("service=Write or service=Read and from=client", {}));
    CHECK(is_chosen("Oven or Tank", {{"value", "\"Oven or Tank\""}})); // no condition
    CHECK(is_value("=\"a or b\"", "\"a or b\""));
}

TEST_CASE("a filter that means nothing is refused")
{
    const std::string filter =
        GENERATE("service=Read or  or time>1", "service=Read or or time>1", "service=Read or ",
                 "service=Read and  and time>1", "=1", "a==1", "time=soon",
                 "message=", "status>Good", "status<=Bad", "node<i=85", "a b=1");
    INFO(filter);
    CHECK_THROWS_AS(MessageFilter{filter}, Failure);
}

} // namespace message_filter_test
