#pragma once

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/server.hpp>

#include "live_ids.hpp"
#include "request_types.hpp"
#include "require.hpp"
#include "support/server_fixture.hpp"
#include "world_image.hpp"

namespace busbar::fuzz {

/// A server of which anything can be asked, with Variables, a Method, events and history of
/// nothing, and two sessions whose user may do everything. Each answer is looked at: it belongs to
/// a request, can be decoded whole, and has as many results as the request has operations.
///
/// To be used for many inputs, begin() and end() around each.
class ServiceWorld {
public:
    static constexpr std::size_t session_count = 2;

    ServiceWorld();

    /// New connections and sessions.
    void begin();
    /// Ends them and lets the time pass; requires that nothing is left.
    void end();
    /// Something was changed that end() does not undo: make another one.
    [[nodiscard]] bool is_used_up() const { return is_used_up_; }

    /// With the session's token, and ids of what there is where the request has small numbers.
    void send(std::size_t session, const RequestTypes::Entry& entry, binary::DynamicValue request);
    /// The bytes as they are.
    void send_raw(std::size_t session, std::uint32_t encoding, std::span<const std::byte> body);
    void advance(Duration time);
    /// Values change, Methods are answered, events are raised, a task scans, whichever bits are
    /// set.
    void act(std::uint8_t choice);

private:
    /// What is known of an answer before it comes.
    struct Expected {
        const binary::DynamicType* response{nullptr};
        std::optional<std::size_t> result_count;
    };
    struct Session {
        std::optional<test::TestClient> client;
        std::map<std::uint32_t, Expected> expected;
    };

    [[nodiscard]] static server::ServerConfig config();
    void add_variables();
    /// With that number as its NodeId.
    model::NodeIndex add_variable(std::uint32_t number, const Variant& value,
                                  std::uint32_t source = model::no_source,
                                  std::uint64_t handle = 0);
    void add_image();
    /// A Variable with an EURange, both of the address space.
    void add_analog();
    void add_method();
    /// Of all attributes that can be written, of the Variables and the Method.
    void allow_writes();
    void set_values(std::int32_t number);
    [[nodiscard]] bool send(Session& session, Expected expected,
                            FunctionRef<void(binary::Writer&)> body);
    void bind(const Session& session, binary::DynamicValue& request) const;
    [[nodiscard]] bool is_busy() const;
    void look();
    void look(Session& session);
    void check(const Expected& expected, std::span<const std::byte> body);

    test::SeededRandom random_;
    test::FixedWallClock wall_clock_;
    NullLog log_;
    test::PlainUsers users_;
    server::MethodTable methods_;
    std::deque<server::MethodCall> calls_;
    server::MemorySource memory_{wall_clock_};
    WorldImage image_;
    TimePoint now_{};
    server::Server server_;
    std::vector<std::uint64_t> handles_;
    std::array<Session, session_count> sessions_;
    /// Of this input.
    LiveIds ids_;
    bool is_used_up_{false};
};

} // namespace busbar::fuzz
