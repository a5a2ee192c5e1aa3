#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <busbar/backend/label.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>

/// What a PLC implements below a DataSource, so that model mode can map its labels to nodes: names
/// become addresses, and labels are read and written by address in batches.
namespace busbar::backend {

/// Why a name stands for no label that can be used (seed 001, 8.3). The codes of the manual are
/// 1921H for all but UnsupportedType, which is 1921H too but is told apart here.
enum class LabelError : std::uint8_t {
    None,
    Unknown,
    NotAccessible, // "Access from External Device" is not chosen
    Constant,      // VAR_GLOBAL_CONSTANT
    NotAName,      // bits, digits, a whole structure or array
    UnsupportedType,
};

/// What a name comes down to.
struct ResolvedLabel {
    LabelError error{LabelError::Unknown};
    LabelKind kind{};
    /// The backend's own; valid until labels change.
    std::uint64_t address{0};
    /// Lies in a device that cannot be sampled in each scan (error 1945H).
    bool is_unsampled_device{false};
};

/// One value within the bytes of a request.
struct LabelPlace {
    std::uint64_t address{0};
    /// In LabelRequest::bytes, little endian as size_of() says.
    std::uint32_t offset{0};
    std::uint32_t size{0};
};

enum class LabelStatus : std::uint8_t {
    Done,
    /// The labels are not those that were resolved, or a place is not as its label and `bytes` are:
    /// resolve all of them anew, then repeat.
    Mismatch,
    NoCommunication,
    /// The PLC is stopping or gone for good.
    Shutdown,
    /// As many requests wait as the backend takes.
    TooManyOperations,
    TooManyPoints,   // of Sample: error 1941H
    UnsampledDevice, // of Sample: error 1945H
    SamplingUnknown, // of Sample: error 1946H, there is no sampling in each scan
};

/// What is asked of a backend. Owns all that it needs, so that asker and backend may end in any
/// order; goes to the backend and comes back with the answer.
struct LabelRequest {
    enum class Kind : std::uint8_t {
        /// `names` to `labels`, one for each.
        Resolve,
        /// The values of `places` to `bytes`: all of them or none.
        Read,
        /// `bytes` to `places`, in their order: all of them or none.
        Write,
        /// `places` are sampled in each scan from now on; `bytes` is as long as they need. What was
        /// sampled before ends when this is started; nothing is sampled if there are no places, or
        /// the answer is not Done. See LabelBackend::sampled.
        Sample,
    };

    Kind kind{Kind::Read};
    std::vector<std::string> names{};
    std::vector<ResolvedLabel> labels{};
    std::vector<LabelPlace> places{};
    std::vector<std::byte> bytes{};

    // The answer; bytes of a Read count with Done only.

    LabelStatus status{LabelStatus::NoCommunication};
    /// When it was done, by the PLC's clock.
    DateTime time{};
    /// Scans that an access was divided over, 1 if it is of one moment.
    std::uint32_t scans{0};

    /// The asker's: which of its requests this is.
    std::uint64_t id{0};
    /// For whoever has it: to chain requests without allocating.
    std::unique_ptr<LabelRequest> next{};
};

/// Who asks a backend. Called on any thread, a PLC's task included: must neither block nor allocate
/// nor call the backend.
class BUSBAR_API LabelListener {
public:
    LabelListener() = default;
    LabelListener(const LabelListener&) = delete;
    LabelListener& operator=(const LabelListener&) = delete;
    virtual ~LabelListener() = default;

    /// A request comes back with its answer.
    virtual void done(std::unique_ptr<LabelRequest> request) = 0;
    /// Names may stand for other addresses and types than before. Requests by the old ones answer
    /// Mismatch.
    virtual void labels_changed() = 0;
};

/// A PLC by the names of its labels. Names are told apart without case, with members behind a
/// period and elements as `[A,B,C]`, see label_name.hpp.
///
/// All functions are for one thread, which is that of the DataSource above; none of them blocks.
class BUSBAR_API LabelBackend {
public:
    LabelBackend() = default;
    LabelBackend(const LabelBackend&) = delete;
    LabelBackend& operator=(const LabelBackend&) = delete;
    virtual ~LabelBackend() = default;

    /// Takes a request; it comes back to the listener, from within this call at the earliest. What
    /// waits when the listener is taken away is dropped.
    virtual void start(std::unique_ptr<LabelRequest> request) = 0;
    /// Who is told; null ends that: when the call returns, the listener is not used any more.
    virtual void attach(LabelListener* listener) = 0;

    /// What the newest scan sampled of the places of the last Sample request, by their offsets into
    /// `bytes`, which must be as long as that request's. Returns the number of that scan, which
    /// grows, and its time; 0 and nothing is written if no scan has been sampled yet. From the
    /// start of a Write to its answer, what it writes to may stay as it was sampled before (seed
    /// 001, 8.3).
    virtual std::uint64_t sampled(std::span<std::byte> /*bytes*/, DateTime& /*time*/) { return 0; }
};

} // namespace busbar::backend
