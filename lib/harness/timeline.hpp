#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/harness/scheduler.hpp>

#include "dissector.hpp"

namespace busbar::harness::detail {

/// The last messages of a network, as they were sent, and what faults did to them: for a test that
/// fails. Costs a copy of each message's first bytes; they are put into words when asked for.
class Timeline {
public:
    /// `scheduler` must outlive it.
    explicit Timeline(const Scheduler& scheduler) : scheduler_{&scheduler} {}

    /// The client of a connection is not just "client".
    void name_client(std::size_t connection, std::string_view name);
    /// `from` has sent the first chunk of a message.
    void sent(std::size_t connection, Side from, const DissectedFrame& frame);
    /// Adds a line about a connection that is not a message: "cut after PublishResponse 3".
    void happened(std::size_t connection, std::string_view what);
    /// The last lines, at most so many: "0.012 s client -> ReadRequest ns=1;s=Level".
    [[nodiscard]] std::string last(std::size_t lines) const;

private:
    static constexpr std::size_t max_entries = 128;
    /// Longer messages are named only.
    static constexpr std::size_t max_bytes = 4'096;

    struct Entry {
        TimePoint time{};
        std::size_t connection{0};
        Side from{Side::Client};
        DissectedFrame frame;
        /// The text of an entry that is not a message; else empty.
        std::string what;
    };
    Entry& next();
    [[nodiscard]] std::string text_of(const Entry& entry) const;

    const Scheduler* scheduler_;
    /// A ring, whose entries keep their memory.
    std::vector<Entry> entries_;
    std::size_t count_{0};
    std::size_t connections_{0};
    /// By the number of the connection.
    std::map<std::size_t, std::string> client_names_;
};

} // namespace busbar::harness::detail
