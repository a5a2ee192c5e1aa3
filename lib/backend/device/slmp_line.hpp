#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <busbar/backend/device.hpp>
#include <busbar/backend/slmp_client.hpp>

#include "slmp_family.hpp"

namespace busbar::backend::detail {

/// A connection to a PLC by SLMP. It begins with the remote password, if there is one, and with the
/// question for the type's name, which also finds out whether the PLC knows the frame.
class SlmpLine : public DeviceLine {
public:
    /// `options` and `findings` must outlive the object.
    SlmpLine(const SlmpProtocolOptions& options, SlmpFindings& findings, TimePoint now);
    ~SlmpLine() override;

    [[nodiscard]] bool is_ready() const override { return is_ready_; }
    [[nodiscard]] bool has_answered() const override { return is_ready_ && has_answered_; }
    Result<void> feed(std::span<const std::byte> in, TimePoint now) override;
    [[nodiscard]] std::span<const std::byte> output() const override { return client_.output(); }
    void consume(std::size_t size) override { client_.consume(size); }
    [[nodiscard]] TimePoint next_deadline() const override { return client_.next_deadline(); }
    void handle_deadline(TimePoint now) override;
    [[nodiscard]] bool is_closed() const override { return client_.is_closed(); }
    [[nodiscard]] std::string reason() const override { return reason_; }
    [[nodiscard]] bool is_denied() const override { return is_denied_; }
    [[nodiscard]] DeviceIdentity identity() const override { return identity_; }

    /// Sends an operation; errors of SlmpClient::send().
    [[nodiscard]] Result<std::uint64_t> ask(SlmpOperation operation, TimePoint now);

protected:
    /// Called with the answer to each operation of ask().
    virtual void answered(SlmpEvent event) = 0;
    /// Passes on what has come.
    void look();
    [[nodiscard]] SlmpFindings& findings() { return findings_; }
    /// The time of the last call.
    [[nodiscard]] TimePoint now() const { return now_; }
    void set_now(TimePoint now) { now_ = now; }

private:
    void ask_first(SlmpCommand command, std::string text);
    /// Takes the answer to a request that the connection begins with.
    void take_first(const SlmpEvent& event);

    const SlmpProtocolOptions& options_;
    SlmpFrame frame_;
    SlmpClient client_;
    SlmpFindings& findings_;
    TimePoint now_;
    /// The request that the connection begins with, and its command.
    std::uint64_t asked_{0};
    SlmpCommand command_{SlmpCommand::TypeName};
    bool is_ready_{false};
    bool has_answered_{false};
    bool is_denied_{false};
    DeviceIdentity identity_;
    std::string reason_;
};

} // namespace busbar::backend::detail
