#include <busbar/net/bus_source.hpp>

#include <array>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/harness/log_book.hpp>

#include "support/source_caller.hpp"

namespace bus_source_test {

// A bus that waits for its answers, as a driver of one's own does.

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;
using test::SourceCaller;
using Words = std::vector<std::uint16_t>;

namespace {

/// The device, as the test and the thread of the source see it.
class Cells {
public:
    /// Answers to come before the device does as it should.
    enum class Fault { Timeout, Lost, Throws, TooFew };

    Result<Words> exchange(const PlanRequest& telegram)
    {
        const std::lock_guard lock{mutex_};
        telegrams_.push_back(telegram);
        if (!faults_.empty()) {
            return fault();
        }
        const PlanAddress& range = telegram.ranges.front();
        if (range.offset <= missing && missing < range.offset + range.width) {
            return fail(status::Bad_ConfigurationError);
        }
        const auto first = words_.begin() + range.offset;
        if (telegram.is_write) {
            std::ranges::copy(telegram.words, first);
        }
        return Words(first, first + range.width);
    }
    Result<void> open()
    {
        const std::lock_guard lock{mutex_};
        ++opened_;
        return opened_ <= refused_ ? Result<void>{fail(status::Bad_CommunicationError)}
                                   : Result<void>{};
    }
    void disturb(Fault fault)
    {
        const std::lock_guard lock{mutex_};
        faults_.push_back(fault);
    }
    void refuse_opening(int times)
    {
        const std::lock_guard lock{mutex_};
        refused_ = opened_ + times;
    }
    [[nodiscard]] int opened()
    {
        const std::lock_guard lock{mutex_};
        return opened_;
    }
    /// The telegrams since the last call.
    std::vector<PlanRequest> telegrams()
    {
        const std::lock_guard lock{mutex_};
        return std::exchange(telegrams_, {});
    }

    static constexpr std::uint32_t missing = 13;

private:
    Result<Words> fault()
    {
        const Fault now = faults_.front();
        faults_.erase(faults_.begin());
        switch (now) {
        case Fault::Timeout:
            return fail(status::Bad_Timeout);
        case Fault::Lost:
            return fail(status::Bad_NoCommunication);
        case Fault::Throws:
            throw std::runtime_error{"no driver"};
        case Fault::TooFew:
            break;
        }
        return Words{};
    }

    std::mutex mutex_;
    std::vector<PlanRequest> telegrams_;
    std::vector<Fault> faults_;
    std::array<std::uint16_t, 64> words_{};
    int opened_{0};
    int refused_{0};
};

class CellBus final : public net::Bus {
public:
    explicit CellBus(Cells& cells) : cells_{cells} {}

    [[nodiscard]] PlanConfig plan() const override
    {
        PlanConfig config;
        config.rules = {{.max_read = 16, .max_write = 16, .max_gap = 4}};
        config.max_under_way = 8; // has no effect
        return config;
    }
    Result<void> open() override { return cells_.open(); }
    Result<Words> read(const PlanRequest& telegram) override { return cells_.exchange(telegram); }
    Result<void> write(const PlanRequest& telegram) override
    {
        return cells_.exchange(telegram).transform([](const Words&) {});
    }

private:
    Cells& cells_;
};

/// What plan() and read() need at least.
class ReadOnlyBus final : public net::Bus {
public:
    [[nodiscard]] PlanConfig plan() const override
    {
        PlanConfig config;
        config.rules = {{.max_read = 16}};
        return config;
    }
    Result<Words> read(const PlanRequest& telegram) override
    {
        return Words(telegram.ranges.front().width, 5);
    }
};

constexpr std::uint64_t state_handle = DeviceSource::status_handle(DeviceFact::State);
constexpr std::uint64_t trouble_handle = DeviceSource::status_handle(DeviceFact::Trouble);

std::vector<DevicePoint> points()
{
    std::vector<DevicePoint> all;
    for (std::uint32_t i = 0; i < 64; ++i) {
        all.push_back({.address = {.offset = i}, .is_writable = true});
    }
    return all;
}

/// A source of the cells at a server's place, online.
struct Station {
    Station() { await_online(); }

    /// Lets completions come until the source is online.
    void await_online()
    {
        while (caller.read({state_handle})[0].value !=
               Variant{static_cast<std::uint32_t>(DeviceState::Online)}) {
            caller.await_wake();
        }
    }
    StatusCode write(std::uint64_t cell, std::uint16_t value)
    {
        return caller.write(cell, DataValue{value});
    }

    Cells cells;
    harness::LogBook log;
    net::BusSource source{std::make_unique<CellBus>(cells),
                          points(),
                          {.log = &log, .first_pause = 1ms, .longest_pause = 2ms}};
    SourceCaller caller{source};
};

} // namespace

TEST_CASE("many points of a bus are few telegrams, and writes come first in their order", "[net]")
{
    Station station;
    CHECK(station.write(3, 33) == StatusCode{});
    CHECK(station.write(4, 44) == StatusCode{});
    const auto values = station.caller.read({12, 3, 0, 4, 3});
    CHECK(values[1].value == Variant{std::uint16_t{33}});
    CHECK(values[3].value == Variant{std::uint16_t{44}});
    CHECK(values[4] == values[1]);
    const auto telegrams = station.cells.telegrams();
    REQUIRE(telegrams.size() == 4);
    CHECK((telegrams[0].is_write && telegrams[1].is_write));
    CHECK(telegrams[2].ranges == std::vector{PlanAddress{0, 0, 5}});
    CHECK(telegrams[3].ranges == std::vector{PlanAddress{0, 12, 1}});
}

TEST_CASE("an address that a bus refuses harms no other one", "[net]")
{
    Station station;
    const auto values = station.caller.read({12, 13, 14});
    CHECK(values[0].status == StatusCode{});
    CHECK(values[1].status == StatusCode{status::Bad_ConfigurationError});
    CHECK(values[2].status == StatusCode{});
    CHECK(station.write(13, 1) == StatusCode{status::Bad_ConfigurationError});
}

TEST_CASE("a telegram of a bus that fails takes only its own values along", "[net]")
{
    const auto [fault, expected] = GENERATE(
        table<Cells::Fault, StatusCode>({{Cells::Fault::Timeout, status::Bad_Timeout},
                                         {Cells::Fault::Throws, status::Bad_InternalError},
                                         {Cells::Fault::TooFew, status::Bad_DecodingError}}));
    Station station;
    station.cells.disturb(fault);
    const auto values = station.caller.read({0, 40});
    CHECK(values[0].status == expected);
    CHECK(values[1].status == StatusCode{});
    CHECK(station.cells.opened() == 1);
    CHECK(station.log.contains("no driver") == (fault == Cells::Fault::Throws));
    CHECK(station.caller.read({0})[0].status == StatusCode{});
}

TEST_CASE("a bus that is lost is opened again, and its values are bad until then", "[net]")
{
    Station station;
    station.cells.disturb(Cells::Fault::Lost);
    station.cells.refuse_opening(3);
    const auto values = station.caller.read({0, 40, trouble_handle});
    CHECK(values[0].status == StatusCode{status::Bad_NoCommunication});
    CHECK(values[1].status == StatusCode{status::Bad_NoCommunication});
    CHECK(station.cells.telegrams().size() == 1);
    station.await_online();
    CHECK(station.cells.opened() == 5);
    CHECK(station.caller.read({0})[0].status == StatusCode{});
    CHECK(station.log.contains("the connection is lost"));
    CHECK(station.log.contains("it cannot be opened: Bad_CommunicationError"));
}

TEST_CASE("a value of a bus has the time of its last change", "[net]")
{
    Station station;
    const auto time = [&] { return station.caller.read({0})[0].source_timestamp; };
    const DateTime first = time();
    CHECK(first != DateTime{});
    CHECK(time() == first);
    CHECK(station.write(0, 7) == StatusCode{});
    const DateTime written = time();
    CHECK(written > first);
    CHECK(time() == written);
    // Its status changes twice.
    station.cells.disturb(Cells::Fault::Timeout);
    const DataValue bad = station.caller.read({0})[0];
    CHECK(bad.status == StatusCode{status::Bad_Timeout});
    CHECK(bad.source_timestamp > written);
    const DateTime back = time();
    CHECK(back > bad.source_timestamp);
    CHECK(time() == back);
}

TEST_CASE("a bus needs no more than its plan and a read", "[net]")
{
    net::BusSource source{std::make_unique<ReadOnlyBus>(), points()};
    SourceCaller caller{source};
    while (caller.read({state_handle})[0].value != Variant{std::uint32_t{2}}) {
        caller.await_wake();
    }
    CHECK(caller.read({7})[0].value == Variant{std::uint16_t{5}});
    CHECK(caller.write(7, DataValue{std::uint16_t{1}}) == StatusCode{status::Bad_NotWritable});
}

TEST_CASE("a source of a bus ends while its bus is not open, and while it waits", "[net]")
{
    Cells cells;
    cells.refuse_opening(1'000);
    net::BusSource source{std::make_unique<CellBus>(cells), points(), {.first_pause = 1h}};
    SourceCaller caller{source};
    do {
        caller.await_wake();
    } while (caller.read({trouble_handle})[0].value == Variant{String{"not connected yet"}});
    CHECK(caller.read({trouble_handle})[0].value ==
          Variant{String{"it cannot be opened: Bad_CommunicationError"}});
    CHECK(caller.read({0})[0].status == StatusCode{status::Bad_NoCommunication});
}

} // namespace bus_source_test
