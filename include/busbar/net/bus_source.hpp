#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <busbar/backend/device_source.hpp>
#include <busbar/backend/plan.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/data_source.hpp>

/// A backend for a bus or protocol of one's own whose calls wait for their answers.
namespace busbar::net {

/// A bus, as a driver library or a serial line has it: a call sends one telegram and waits for the
/// answer. A BusSource makes all calls on one thread, one after the other; none of them may wait
/// for ever. An exception fails the telegram, or the attempt to open the connection, with
/// Bad_InternalError, or Bad_OutOfMemory.
///
/// The error says what comes next. Bad_Timeout: this telegram has no answer, others go on.
/// Bad_NoCommunication: the connection is lost, and open() is called. Any other: the device refuses
/// an address, a length or a value of the telegram, which is divided until that is found.
class BUSBAR_API Bus {
public:
    Bus() = default;
    Bus(const Bus&) = delete;
    Bus& operator=(const Bus&) = delete;
    virtual ~Bus() = default;

    /// Returns what fits into a telegram, for each area. Called once, by the constructor of the
    /// source. PlanConfig::max_under_way has no effect.
    [[nodiscard]] virtual backend::PlanConfig plan() const = 0;
    /// Opens the connection: before the first telegram, again after it is lost, and after a pause
    /// if this fails.
    virtual Result<void> open() { return {}; }
    /// Reads all ranges of a telegram, and returns their words, one range after the other.
    virtual Result<std::vector<std::uint16_t>> read(const backend::PlanRequest& telegram) = 0;
    /// Writes PlanRequest::words to its ranges; of a bit of a word (DevicePoint::bit) only the bits
    /// of PlanRequest::mask. Not overridden by a bus that is only read.
    virtual Result<void> write(const backend::PlanRequest& /*telegram*/)
    {
        return fail(status::Bad_NotWritable);
    }
};

/// The configuration of a BusSource.
struct BusSourceOptions {
    /// The name in the log.
    std::string name{"bus"};
    /// Gets lost and found connections, and exceptions; may be null. It must outlive the source.
    LogSink* log{nullptr};
    /// Pause after the first failed open(); it doubles with each further one.
    Duration first_pause{std::chrono::milliseconds{500}};
    /// The longest pause.
    Duration longest_pause{std::chrono::seconds{30}};
    /// The timeout of a batch, and the answers while the bus is away.
    backend::DeviceSourceOptions source{};
};

/// Serves the points of a Bus as Variables. What backend::Device and backend::DeviceSource do for
/// Modbus and SLMP they do here: few telegrams for many addresses, refused ones found, writes kept
/// in order, Bad_NoCommunication at once while the connection is lost, pauses before open(),
/// maxAge, and the state as Variables (backend::DeviceSource::status_handle).
class BUSBAR_API BusSource final : public server::DataSource {
public:
    /// The handle of points[i] is i. Opens the connection as soon as a server has the source.
    BusSource(std::unique_ptr<Bus> bus, std::vector<backend::DevicePoint> points,
              const BusSourceOptions& options = {});
    /// Waits until the call of the bus that is under way has returned.
    ~BusSource() override;

    /// Returns the timeout of BusSourceOptions::source, and defaults.
    [[nodiscard]] server::DataSourceOptions options() const override;
    /// Answers at once while the connection is lost.
    void read(server::ReadBatch batch) override;
    /// Likewise.
    void write(server::WriteBatch batch) override;
    /// Opens the connection, unless that is done.
    void attach(server::Waker* waker) override;
    /// Completes the batches that the bus has answered.
    void handle_completions() override;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net
