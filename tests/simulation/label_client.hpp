#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <busbar/harness/client_host.hpp>
#include <busbar/types/subscription.hpp>

#include "harness_names.hpp"
#include "trace.hpp"

namespace busbar::test {

/// What the clients of a LabelSimulation know of its labels. Each client has a Variable of its own
/// that only it writes: its number and, behind that, how often it has begun to.
struct LabelBoard {
    static constexpr std::int32_t step = 1'000'000;
    /// Mode, which has other types from program to program, and always this value.
    static constexpr std::int16_t mode = 77;

    /// Variables by number: those of the clients, then Mode, Count and Twin, which are equal and
    /// count in each scan.
    [[nodiscard]] std::size_t mode_index() const { return written.size(); }
    [[nodiscard]] std::size_t count_index() const { return written.size() + 1; }
    [[nodiscard]] std::size_t twin_index() const { return written.size() + 2; }
    [[nodiscard]] std::size_t variables() const { return written.size() + 3; }
    [[nodiscard]] std::string name(std::size_t variable) const;

    /// What each client has begun to write last.
    std::vector<std::int32_t> written{};
};

/// A client that reads, writes and monitors labels that change, and knows what it may see.
class LabelClient {
public:
    LabelClient(harness::World& world, LabelBoard& board, Trace& trace, std::size_t number,
                Chance chance);

    /// Connects and monitors its own Variable, its neighbour's, Count and Twin.
    void start();
    /// Begins nothing new.
    void calm() { next_.cancel(); }
    /// Everything is as it was written last, and has been told. When all is quiet.
    void check_end();
    void leave();

    /// Good values that were seen, and answers that said that there are none now.
    [[nodiscard]] std::uint64_t good() const { return good_; }
    [[nodiscard]] std::uint64_t bad() const { return bad_; }
    /// Notifications with Good_Overload.
    [[nodiscard]] std::uint64_t overloads() const { return overloads_; }

private:
    void act();
    void read();
    void write();
    void publish();
    void take_read(const Result<ReadResponse>& response);
    void take_write(const Result<WriteResponse>& response, std::int32_t value);
    void take_notification(const PublishResponse& response);
    /// False for a service that did nothing, which it must have a reason for.
    [[nodiscard]] bool check_service(const char* what, StatusCode result);
    void check_value(const char* what, std::size_t variable, const DataValue& data);
    void check_number(const char* what, std::size_t variable, std::int32_t number);
    void violation(const std::string& what) { trace_.violation(number_, what); }

    LabelBoard& board_;
    Trace& trace_;
    std::size_t number_;
    Chance chance_;
    harness::ClientHost host_;
    /// What its own Variable has for certain.
    std::int32_t confirmed_;
    /// The newest of each Variable that it saw by Read, and what it was told last of items.
    std::vector<std::int32_t> seen_;
    std::vector<std::int32_t> told_;
    std::vector<std::size_t> items_;
    std::vector<StatusCode> told_status_;
    std::optional<SubscriptionAcknowledgement> to_acknowledge_;
    bool is_over_{false};
    bool is_writing_{false};
    std::uint64_t good_{0};
    std::uint64_t bad_{0};
    std::uint64_t overloads_{0};
    Alarm next_;
};

} // namespace busbar::test
