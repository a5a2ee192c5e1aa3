#pragma once

#include <cstddef>
#include <memory>

#include <busbar/backend/device.hpp>
#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/label_backend.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>

namespace busbar::backend {

/// The configuration of SlmpLabels.
struct SlmpLabelsOptions {
    /// The PLC.
    DeviceConfig device{};
    /// Its protocol; the members about devices are not used.
    SlmpProtocolOptions protocol{};
    /// Labels of one request.
    std::size_t max_labels{32};
    /// Bytes of names and values of one request.
    std::size_t max_bytes{1'200};
    /// Requests of the owner that wait; beyond: TooManyOperations.
    std::size_t max_waiting{64};
};

/// The global labels of a PLC by name (SLMP, commands 041C and 141B), for model mode. The PLC gives
/// only those that have "Access from External Device". It says a label's type when it is asked, so
/// that names are resolved by reading them; labels count as changed with each new connection, since
/// the protocol does not tell of another program.
///
/// One request of the owner is under way at a time, in as few messages as the limits allow:
/// LabelRequest::scans is their number. Sampling in each scan is not supported.
class BUSBAR_API SlmpLabels final : public LabelBackend {
public:
    /// `now` returns the time that the device's driver has, too. `clock` and `log` must outlive the
    /// object.
    SlmpLabels(SlmpLabelsOptions options, const WallClock& clock, TimePoint (*now)(), LogSink& log);
    ~SlmpLabels() override;

    /// The PLC, for a driver of its connection.
    [[nodiscard]] Device& device();

    void start(std::unique_ptr<LabelRequest> request) override;
    void attach(LabelListener* listener) override;

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
