#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller {

namespace detail {
class LabelServerSide;
class LabelTaskSide;
struct LabelExchange;
} // namespace detail

struct SimulatedLabelsOptions {
    /// Maximum number of requests waiting for scans. More answer TooManyOperations.
    std::size_t max_waiting{64};
    /// Points, which are words or single bits, that all requests together read and write at the end
    /// of one scan (SH-082679, 8.3: access unit); the rest waits for the next scans. 0:
    /// all at once, so that nothing is torn. One value is never divided, however long it is.
    std::uint32_t access_unit{0};
    /// Whether labels can be sampled in each scan at all.
    bool can_sample{true};
    /// The points of one Sample request, which are rounded up to the next multiple of 8,192.
    std::uint32_t max_sampled_points{32'768};
    /// Says what happens to declarations that cannot be labels.
    Unserved unserved{Unserved::Refuse};

    friend bool operator==(const SimulatedLabelsOptions&, const SimulatedLabelsOptions&) = default;
};

/// The labels of a simulated PLC: a backend whose program runs in this process.
///
/// Requests wait for the end of a scan, where they are served in their order, with the scan's time;
/// only requests that need no waiting, such as one too many, are answered within start(). A Write
/// is refused as a whole or done as a whole, unless labels change or communication ends between the
/// scans over which it is divided. From the arrival of a Write to its end its labels are not
/// sampled: they keep their last sample.
///
/// Threads: the functions of LabelBackend are for one thread, end_of_scan(), halt() and memory()
/// for another one, the PLC's, the rest for any thread.
class BUSBAR_API SimulatedLabels final : public backend::LabelBackend {
public:
    [[nodiscard]] static Configured<std::unique_ptr<SimulatedLabels>>
    create(Program program, const SimulatedLabelsOptions& options = {});
    ~SimulatedLabels() override;

    void start(std::unique_ptr<backend::LabelRequest> request) override;
    void attach(backend::LabelListener* listener) override;
    std::uint64_t sampled(std::span<std::byte> bytes, DateTime& time) override;
    /// Looks in the newest program, also before the first scan.
    [[nodiscard]] std::optional<std::vector<backend::ResolvedLabel>>
    look_up(std::span<const std::string> names) const override;

    /// Serves waiting requests, then samples. Never waits, allocates or frees: a bounded number of
    /// steps, which grows with the options, and with the size of a program if that is replaced.
    void end_of_scan(DateTime now);
    /// The PLC stops: waiting requests answer NoCommunication, and so do all later ones until the
    /// next end_of_scan().
    void halt(DateTime now);
    /// The memory that the PLC's programs work in now. Unchanged until an end_of_scan() after
    /// replace_program().
    [[nodiscard]] server::ImageMemory& memory();

    /// An online change: from now on names are those of `program`, and labels resolved before
    /// answer Mismatch. At the next end of a scan variables with the same name and type keep their
    /// values, and memory() changes; the old one lives as long as an image() of it is held. The
    /// listener is called from within this call. Nothing changes with a Problem.
    [[nodiscard]] Configured<void> replace_program(Program program);
    /// The newest program.
    [[nodiscard]] std::shared_ptr<const LabelProgram> program() const;

    /// For tests: from the next end of a scan on all requests answer `fault`, and nothing is
    /// sampled; Done ends it.
    void fail_with(backend::LabelStatus fault);

private:
    SimulatedLabels(std::shared_ptr<LabelProgram> program, const SimulatedLabelsOptions& options);

    std::unique_ptr<detail::LabelExchange> exchange_;
    std::unique_ptr<detail::LabelServerSide> server_;
    std::unique_ptr<detail::LabelTaskSide> task_;
};

} // namespace busbar::controller
