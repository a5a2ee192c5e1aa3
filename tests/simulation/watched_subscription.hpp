#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "notification_check.hpp"
#include "plant.hpp"

namespace busbar::test {

/// One item of a simulated client: what it is to be, and what the server has confirmed. What a
/// lost response leaves open has no value.
struct Watch {
    enum class State : std::uint8_t {
        Wanted,   // not created yet
        Asked,    // CreateMonitoredItems is under way
        Live,     // created
        Unwanted, // to be deleted
        Gone,     // deleted, or nobody knows: kept for a while for what comes late
    };

    Plant::Kind kind{Plant::Kind::Scan};
    std::size_t counter{0};
    State state{State::Wanted};
    std::uint32_t item_id{0};
    std::uint32_t wanted_queue_size{10};
    std::optional<std::uint32_t> queue_size;
    MonitoringMode wanted_mode{MonitoringMode::Reporting};
    std::optional<MonitoringMode> mode;
    /// What the plant had counted when the item was asked for.
    std::int64_t first_count{0};
    /// Since when it reports as it does.
    TimePoint since;
    /// When the server told last that events were lost.
    TimePoint loss_told;
    CountCheck check;
};

[[nodiscard]] MonitoringParameters parameters_of(const Watch& watch, std::uint32_t client_handle);

/// Who looks at what is delivered.
class DeliveryJudge {
public:
    [[nodiscard]] virtual TimePoint now() const = 0;
    /// That number of the item may be missing.
    [[nodiscard]] virtual bool may_miss(const Watch& watch, std::int64_t number) const = 0;
    virtual void violation(const std::string& what) = 0;

protected:
    ~DeliveryJudge() = default;
};

/// What a simulated client knows of one of its Subscriptions, and expects of it.
class WatchedSubscription {
public:
    WatchedSubscription(std::uint32_t subscription_id, std::uint32_t kept_messages)
        : id{subscription_id}, sequence{kept_messages}
    {
    }

    /// Looks at what a message brings.
    void deliver(const NotificationMessage& message, DeliveryJudge& judge);
    void add_watch(Plant::Kind kind, std::size_t counter, std::uint32_t queue_size);
    /// Notifications may be missing, or come twice, for a reason.
    void allow_gaps();
    /// Each item's value is to come once more.
    void allow_repeats();

    /// The shortest interval after which the server, for all that is known, looks for something to
    /// send is at most this.
    [[nodiscard]] Duration cycle() const;
    /// It lives at least so long after its last_use.
    [[nodiscard]] std::chrono::duration<double, std::milli> least_lifetime() const
    {
        // The interval in which the counter was set takes one off it (Part 4, 5.14.1.2).
        return std::chrono::duration<double, std::milli>{shortest_interval * (lifetime_count - 1)};
    }
    /// In how many messages all that its queues may hold is sent.
    [[nodiscard]] std::size_t messages() const;
    /// A message has come, or what there is instead.
    void heard(TimePoint now);

    std::uint32_t id;
    SequenceCheck sequence;

    double wanted_interval{0};
    std::optional<double> interval;
    /// The shortest and the longest that it ever had.
    double shortest_interval{0};
    double longest_interval{0};
    std::uint32_t keep_alive_count{0};
    std::uint32_t lifetime_count{0};
    std::uint32_t max_notifications{0};
    std::uint8_t priority{0};
    /// In a storm it has more to send than its client asks for.
    bool is_saturated{false};
    bool wants_publishing{true};
    std::optional<bool> publishing{true};

    /// It may belong to a session that is lost.
    bool needs_transfer{false};
    bool is_transfer_open{false};
    /// Republish until there is nothing more, whether or not something is known to be missing.
    bool asks_for_more{false};
    /// Messages are lost for good: the last value of an item may have been in one of them.
    bool needs_values{false};
    /// When a request was sent that the server has answered and that kept the Subscription alive.
    TimePoint last_use;
    TimePoint created;
    /// When it brought a message, a keep-alive at least.
    std::optional<TimePoint> last_heard;
    /// Since when nothing that the client did keeps it from sending what there is.
    TimePoint undisturbed_since;
    /// Something has come since the client is ready: what was lost before that is known.
    bool is_caught_up{false};

    struct Acknowledgement {
        std::uint32_t number;
        /// False if the server may know it already, or never did.
        bool is_certain;
    };
    std::deque<Acknowledgement> acknowledgements;

    /// By client handle.
    std::map<std::uint32_t, Watch> watches;

private:
    void deliver_value(const MonitoredItemNotification& item, DeliveryJudge& judge);
    void deliver_event(const EventFieldList& event, DeliveryJudge& judge);
    [[nodiscard]] Watch* find(std::uint32_t handle, DeliveryJudge& judge);

    std::uint32_t last_handle_{0};
};

} // namespace busbar::test
