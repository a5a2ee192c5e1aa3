#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <busbar/backend/slmp_message.hpp>
#include <busbar/harness/slmp_responder.hpp>

#include "harness/slmp/plc_memory.hpp"

namespace busbar::harness::detail {

struct PlcMishap {
    SlmpMishap kind{SlmpMishap::None};
    std::size_t count{0};
    std::uint16_t end_code{0};
};

/// The state that the connections to a PLC share.
struct SharedPlc {
    SlmpPlcOptions options;
    PlcMemory memory{};
    PlcLabels labels{};
    std::deque<PlcMishap> mishaps{};
    std::uint64_t served{0};
    bool is_running{true};

    /// RUN, or STOP or PAUSE, which SD203 has, too, if there is one.
    void set_mode(std::uint16_t mode)
    {
        is_running = mode == run;
        static_cast<void>(memory.write_words(mode_device, {&mode, 1}));
    }
    static constexpr std::uint16_t run = 0;
    static constexpr std::uint16_t stop = 2;
    static constexpr std::uint16_t pause = 3;
    static constexpr backend::SlmpDevice mode_device{0xA9, 203};
};

/// Serves the operations of one connection, whatever the frames are that they come in.
class PlcService {
public:
    /// `plc` must outlive the object.
    explicit PlcService(SharedPlc& plc) : plc_{&plc} { reconnect(); }

    /// Returns the end code.
    [[nodiscard]] std::uint16_t serve(const backend::SlmpOperation& operation,
                                      backend::SlmpAnswer& answer);
    /// The devices that were registered.
    [[nodiscard]] const std::optional<backend::SlmpOperation>& monitor() const { return monitor_; }
    /// The port is locked again if it has a password.
    void reconnect() { is_locked_ = !plc_->options.password.empty(); }

private:
    [[nodiscard]] std::uint16_t check(const backend::SlmpOperation& operation) const;
    [[nodiscard]] std::uint16_t check_size(const backend::SlmpOperation& operation) const;
    [[nodiscard]] std::uint16_t read(const backend::SlmpOperation& operation,
                                     backend::SlmpAnswer& answer) const;
    [[nodiscard]] std::uint16_t write(const backend::SlmpOperation& operation);
    [[nodiscard]] std::uint16_t control(const backend::SlmpOperation& operation);
    [[nodiscard]] std::uint16_t end_code_of(PlcMemory::Access access) const;

    SharedPlc* plc_;
    std::optional<backend::SlmpOperation> monitor_{};
    bool is_locked_{false};
};

} // namespace busbar::harness::detail
