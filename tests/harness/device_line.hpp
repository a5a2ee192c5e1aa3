#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/backend/device.hpp>
#include <busbar/harness/log_book.hpp>

namespace busbar::test {

using backend::Device;
using backend::DeviceConfig;
using backend::DeviceProtocol;
using backend::PlanAddress;
using backend::PlanValue;
using harness::LogBook;

/// A device, and the PLC's end of its connection while there is one.
template <typename Responder>
class Line {
public:
    Line(DeviceConfig config, std::unique_ptr<DeviceProtocol> protocol)
        : device{std::move(config), std::move(protocol), log}
    {
    }

    /// Connects, as a driver does when the device wants it.
    void connect(Responder& responder)
    {
        REQUIRE(device.wants_connection(now));
        device.connecting(now);
        plc = &responder;
        device.connected(now);
        move();
    }
    void cut(const std::string& reason)
    {
        plc = nullptr;
        device.lost(reason, now);
    }
    /// Moves bytes until nothing is left, without time passing.
    void move()
    {
        for (bool is_moving = true; is_moving && plc != nullptr;) {
            is_moving = pass(device, *plc) || pass(*plc, device);
            if (device.is_closed() || (plc->is_closed() && plc->output().empty())) {
                cut("closed");
            }
        }
    }
    /// Lets time pass, deadline by deadline.
    void advance(Duration time)
    {
        const TimePoint end = now + time;
        for (;;) {
            TimePoint next = device.next_deadline();
            if (plc != nullptr) {
                next = std::min(next, plc->next_deadline());
            }
            if (next > end) {
                break;
            }
            now = std::max(now, next);
            device.handle_deadline(now);
            if (plc != nullptr) {
                plc->handle_deadline(now);
            }
            move();
            if (plc == nullptr && device.is_closed()) {
                cut("closed");
            }
            if (next == now && device.next_deadline() <= now) {
                break; // it waits for a connection
            }
        }
        now = end;
    }
    [[nodiscard]] std::vector<StatusCode> read(std::vector<PlanAddress> addresses)
    {
        const auto batch = device.read(addresses, now);
        if (!batch) {
            return {batch.error()};
        }
        move();
        return statuses();
    }
    [[nodiscard]] std::vector<StatusCode>
    write(const std::vector<PlanAddress>& addresses,
          const std::vector<std::vector<std::uint16_t>>& values)
    {
        std::vector<backend::PlanWrite> writes;
        for (std::size_t i = 0; i < addresses.size(); ++i) {
            writes.push_back({addresses[i], values[i]});
        }
        const auto batch = device.write(writes, now);
        if (!batch) {
            return {batch.error()};
        }
        move();
        return statuses();
    }
    [[nodiscard]] std::vector<StatusCode> statuses()
    {
        std::vector<StatusCode> all;
        words.clear();
        if (const auto result = device.next_result()) {
            for (const PlanValue& value : result->values) {
                all.push_back(value.status);
                if (!result->is_write) {
                    const auto some = result->words_of(value);
                    words.insert(words.end(), some.begin(), some.end());
                }
            }
        }
        return all;
    }

    LogBook log;
    TimePoint now{};
    Device device;
    Responder* plc{nullptr};
    /// Of the last result.
    std::vector<std::uint16_t> words;

private:
    template <typename From, typename To>
    bool pass(From& from, To& to)
    {
        // All that is there, as a stream brings it.
        std::vector<std::byte> bytes;
        for (auto out = from.output(); !out.empty(); out = from.output()) {
            bytes.insert(bytes.end(), out.begin(), out.end());
            from.consume(out.size());
        }
        if (!bytes.empty()) {
            static_cast<void>(to.feed(bytes, now));
        }
        return !bytes.empty();
    }
};

} // namespace busbar::test
