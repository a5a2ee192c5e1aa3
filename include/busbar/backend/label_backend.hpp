#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/backend/label.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>

/// The interface that a PLC implements below a DataSource, so that model mode can map its labels to
/// nodes: names become addresses, and labels are read and written by address in batches.
namespace busbar::backend {

/// The reason why a name is not a usable label (SH-082679, 8.3). The manual's code is
/// 1921H for all of them, including UnsupportedType, which is distinguished here.
enum class LabelError : std::uint8_t {
    None,
    Unknown,
    NotAccessible, // "Access from External Device" is not chosen
    Constant,      // VAR_GLOBAL_CONSTANT
    NotAName,      // bits, digits, a whole structure or array
    UnsupportedType,
};

/// The result of resolving a name.
struct ResolvedLabel {
    LabelError error{LabelError::Unknown};
    LabelKind kind{};
    /// The backend's address; valid until labels change.
    std::uint64_t address{0};
    /// The label is in a device that cannot be sampled in each scan (error 1945H).
    bool is_unsampled_device{false};
};

/// One value within the bytes of a request.
struct LabelPlace {
    std::uint64_t address{0};
    /// Offset in LabelRequest::bytes, whose layout follows size_of(), little endian.
    std::uint32_t offset{0};
    std::uint32_t size{0};
};

/// The result of a request; with any but Done no value was read or written.
enum class LabelStatus : std::uint8_t {
    Done,
    /// The labels have changed since they were resolved, or a place does not fit its label and
    /// `bytes`: resolve all of them again, then repeat.
    Mismatch,
    NoCommunication,
    /// The PLC is stopping or has ended.
    Shutdown,
    /// The backend's maximum number of requests is waiting.
    TooManyOperations,
    TooManyPoints,   // for Sample: error 1941H
    UnsampledDevice, // for Sample: error 1945H
    SamplingUnknown, // for Sample: error 1946H, sampling in each scan is not supported
};

/// A request to a backend. Owns everything that it needs, so that sender and backend may end in any
/// order; goes to the backend and returns with the answer.
struct LabelRequest {
    /// The operation, which says which of the other members are used.
    enum class Kind : std::uint8_t {
        /// Converts `names` to `labels`, one for each.
        Resolve,
        /// Reads the values of `places` into `bytes`: all of them or none.
        Read,
        /// Writes `bytes` to `places`, in their order: all of them or none.
        Write,
        /// Samples `places` in each scan from now on; `bytes` has the size that they need. Previous
        /// sampling ends when this is started; nothing is sampled if there are no places, or the
        /// answer is not Done. See LabelBackend::sampled.
        Sample,
    };

    Kind kind{Kind::Read};
    std::vector<std::string> names{};
    std::vector<ResolvedLabel> labels{};
    std::vector<LabelPlace> places{};
    std::vector<std::byte> bytes{};

    // The answer; the bytes of a Read are valid only with Done.

    LabelStatus status{LabelStatus::NoCommunication};
    /// The time of execution, by the PLC's clock.
    DateTime time{};
    /// Number of scans over which an access was spread, 1 if it is of one moment.
    std::uint32_t scans{0};

    /// Set by the sender to identify its request.
    std::uint64_t id{0};
    /// Used by the present owner to chain requests without allocating.
    std::unique_ptr<LabelRequest> next{};
};

/// Receives the answers of a backend. Called on any thread, a PLC's task included: must neither
/// block nor allocate nor call the backend.
class BUSBAR_API LabelListener {
public:
    LabelListener() = default;
    LabelListener(const LabelListener&) = delete;
    LabelListener& operator=(const LabelListener&) = delete;
    virtual ~LabelListener() = default;

    /// A request returns with its answer.
    virtual void done(std::unique_ptr<LabelRequest> request) = 0;
    /// Names may refer to other addresses and types than before. Requests with the old ones answer
    /// Mismatch.
    virtual void labels_changed() = 0;
};

/// A PLC by the names of its labels. Names are compared without case; members follow a dot, and
/// elements are written as `[A,B,C]`, see label_name.hpp.
///
/// All functions but look_up() are called on one thread, that of the DataSource above; none of them
/// blocks.
class BUSBAR_API LabelBackend {
public:
    LabelBackend() = default;
    LabelBackend(const LabelBackend&) = delete;
    LabelBackend& operator=(const LabelBackend&) = delete;
    virtual ~LabelBackend() = default;

    /// Takes a request; it returns to the listener, from within this call at the earliest. Requests
    /// that wait when the listener is removed are dropped.
    virtual void start(std::unique_ptr<LabelRequest> request) = 0;
    /// Sets the listener; null removes it: when the call returns, it is not used any more.
    virtual void attach(LabelListener* listener) = 0;

    /// Copies the values that the newest scan sampled for the places of the last Sample request, by
    /// their offsets, to `bytes`, which must be as long as that request's. Returns the number of
    /// that scan, which increases, and its time; returns 0 and writes nothing if no scan has been
    /// sampled yet. From the start of a Write to its answer, the written values may stay as sampled
    /// before (SH-082679, 8.3).
    virtual std::uint64_t sampled(std::span<std::byte> /*bytes*/, DateTime& /*time*/) { return 0; }

    /// Returns the labels that the names stand for now, one for each, without a request; addresses
    /// do not count. Nothing, the default, if the PLC has to be asked for that. Any thread.
    [[nodiscard]] virtual std::optional<std::vector<ResolvedLabel>>
    look_up(std::span<const std::string> /*names*/) const
    {
        return std::nullopt;
    }
};

} // namespace busbar::backend
