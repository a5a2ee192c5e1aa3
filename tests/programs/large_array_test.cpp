#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/client/attributes.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>

#include "programs/controllers.hpp"

namespace large_array_test {

// An array that is larger than the default limits, whole and in parts, between programs.

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::size_t element_count = 300'000;
const NodeId curve{2, "Curve"};

/// Without security, with the variable Curve of so many Int32.
std::string configuration_with(const std::string& limits, std::size_t elements)
{
    return R"(
[[endpoint]]
policy = "None"
[users]
anonymous = "write"
[limits]
)" + limits +
           R"(
[[plc.variable]]
name = "Curve"
type = "Int32"
dimensions = [)" +
           std::to_string(elements) + "]\n";
}

/// "[1,2,3]"
std::string list_up_to(int last)
{
    std::string text = "[1";
    for (int i = 2; i <= last; ++i) {
        text += "," + std::to_string(i);
    }
    return text + "]";
}

struct End {
    int exit;
    std::string output;
};

/// A controller, and what is run against it.
class Plant {
public:
    Plant(const std::string& limits, std::size_t elements)
        : controller{scratch, "large", configuration_with(limits, elements)}
    {
    }
    [[nodiscard]] End busbar(std::vector<std::string> arguments) const
    {
        arguments.insert(arguments.begin(), BUSBAR);
        arguments.emplace_back("--insecure");
        Program program{std::move(arguments),
                        scratch.path(),
                        scratch.path() + "/output",
                        {{"HOME", scratch.path()}, {"BUSBAR_URL", controller.url()}}};
        const int exit = program.wait_for_end();
        return {exit, program.output()};
    }

    ScratchFolder scratch;
    Controller controller;
};

/// A program that uses the client library.
class User {
public:
    explicit User(const Plant& plant, std::uint32_t max_array_length)
        : client{config(plant, max_array_length), environment}
    {
        REQUIRE(client.connect());
    }
    [[nodiscard]] DataValue read(std::string_view range = {})
    {
        using Values = std::vector<DataValue>;
        const auto values = client.wait_for<Values>([&](auto done) {
            return client::read(client.client(),
                                {client::attribute_of(curve, AttributeId::Value, range)}, done);
        });
        REQUIRE(values);
        return values->front();
    }
    [[nodiscard]] StatusCode write(Array<std::int32_t> elements, std::string_view range = {})
    {
        DataValue value;
        value.value = Variant{std::move(elements)};
        using Statuses = std::vector<StatusCode>;
        const auto statuses = client.wait_for<Statuses>([&](auto done) {
            return client::write(
                client.client(),
                {client::value_for(curve, std::move(value), AttributeId::Value, range)}, done);
        });
        REQUIRE(statuses);
        return statuses->front();
    }

private:
    static client::ClientConfig config(const Plant& plant, std::uint32_t max_array_length)
    {
        client::ClientConfig config;
        config.endpoint_url = plant.controller.url();
        config.security.allows_none = true;
        config.decode.max_array_length = max_array_length;
        return config;
    }

    crypto::SystemRandom random;
    net::SystemWallClock clock;
    net::StderrLog log{LogLevel::Error};
    channel::ChannelEnvironment environment{.random = &random, .wall_clock = &clock, .log = &log};
    net::BlockingClient client;
};

Array<std::int32_t> sevens(std::size_t count)
{
    Array<std::int32_t> elements(count);
    for (std::size_t i = 0; i < count; ++i) {
        elements[i] = static_cast<std::int32_t>(7 * i);
    }
    return elements;
}

} // namespace

TEST_CASE("300,000 elements go whole and in parts between a controller and its users")
{
    const Plant plant{"array_length = 300000", element_count};
    User user{plant, element_count};
    Array<std::int32_t> elements = sevens(element_count);
    REQUIRE(user.write(elements) == StatusCode{});
    CHECK(user.read().value == Variant{elements});

    CHECK(user.read("299998:299999").value == Variant{Array<std::int32_t>{2'099'986, 2'099'993}});
    CHECK(user.write({-1, -2, -3}, "149999:150001") == StatusCode{});
    std::copy_n(Array<std::int32_t>{-1, -2, -3}.begin(), 3, elements.begin() + 149'999);
    CHECK(user.read().value == Variant{elements});
    CHECK(user.read("300000").status == status::Bad_IndexRangeNoData);
    CHECK(user.write({1, 2}, "299999:300000") == status::Bad_IndexRangeNoData);
    CHECK(user.read("299999").value == Variant{Array<std::int32_t>{2'099'993}});
}

TEST_CASE("busbar reads 300,000 elements whole, and reads and writes parts of them",
          "[unit:Attribute Client Read by Index]"
          "[unit:Attribute Client Write by Index]")
{
    const Plant plant{"array_length = 300000", element_count};
    REQUIRE(
        plant.busbar({"write", "ns=2;s=Curve", "--range", "299990:299999", list_up_to(10)}).exit ==
        0);
    const End part = plant.busbar({"read", "ns=2;s=Curve", "--range", "299988:299991", "--value"});
    CHECK(part.exit == 0);
    CHECK(part.output.ends_with("[0, 0, 1, 2]\n"));
    const End whole = plant.busbar({"read", "ns=2;s=Curve", "--json"});
    CHECK(whole.exit == 0);
    CHECK(std::count(whole.output.begin(), whole.output.end(), ',') >=
          static_cast<std::ptrdiff_t>(element_count - 1));
    CHECK(whole.output.find(",0,1,2,3,4,5,6,7,8,9,10]") != std::string::npos);
    const End shown = plant.busbar({"read", "ns=2;s=Curve"});
    CHECK(shown.output.find("Int32[300000]") != std::string::npos);
    CHECK(shown.output.find("... 299900 more elements") != std::string::npos);
}

TEST_CASE("what limits refuse is told with the key to raise")
{
    const Plant plant{"array_length = 1000\nmessage_size = 8192", 1'000};
    const auto written = [&](const std::string& value) {
        return plant.busbar({"write", "ns=2;s=Curve", value});
    };
    CHECK(written(list_up_to(1'000)).exit == 0);
    const End long_array = written(list_up_to(1'001));
    CHECK(long_array.exit == 1);
    CHECK(long_array.output.find("Bad_EncodingLimitsExceeded") != std::string::npos);
    CHECK(long_array.output.find("array_length") != std::string::npos);
    const End large_request = written(list_up_to(3'000));
    CHECK(large_request.exit == 1);
    CHECK(large_request.output.find("Bad_RequestTooLarge") != std::string::npos);
    CHECK(large_request.output.find("message_size") != std::string::npos);
    // The configuration is refused with them before anybody can ask (config_test.cpp). Users of
    // the library raise ClientConfig::decode.
    CHECK(User{plant, 999}.read().status == status::Bad_EncodingLimitsExceeded);
    CHECK(User{plant, 1'000}.read().value == Variant{[] {
              Array<std::int32_t> numbers(1'000);
              std::generate(numbers.begin(), numbers.end(), [n = 0]() mutable { return ++n; });
              return numbers;
          }()});
}

} // namespace large_array_test
