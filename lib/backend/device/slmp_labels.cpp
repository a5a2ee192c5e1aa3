#include <busbar/backend/slmp_labels.hpp>

#include <algorithm>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <busbar/backend/slmp_end_code.hpp>
#include <busbar/core/status_codes.hpp>

#include "slmp_line.hpp"

namespace busbar::backend {

namespace {

/// The labels of one message: some of those of a request, by their places in it.
struct Part {
    std::size_t first{0};
    std::size_t count{0};
};

/// The type of a value with this id and size; nothing for ids that are unknown, and for sizes that
/// the type does not have.
std::optional<LabelKind> kind_of(const SlmpLabelValue& value)
{
    constexpr std::size_t terminator = 2;
    const std::size_t size = value.data.size();
    LabelKind kind;
    switch (value.type) {
    case 1:
        kind.type = LabelType::Bit;
        return size > 0 ? std::optional{kind} : std::nullopt;
    case 2:
        kind.type = LabelType::UnsignedWord;
        break;
    case 3:
        kind.type = LabelType::UnsignedDoubleWord;
        break;
    case 4:
        kind.type = LabelType::Word;
        break;
    case 5:
        kind.type = LabelType::DoubleWord;
        break;
    case 6:
        kind.type = LabelType::Float;
        break;
    case 7:
        kind.type = LabelType::Double;
        break;
    case 8:
        kind.type = LabelType::Time;
        break;
    case 9:
        kind.type = LabelType::String;
        kind.length = static_cast<std::uint32_t>(size - std::min(size, terminator));
        return size >= terminator ? std::optional{kind} : std::nullopt;
    case 10:
        kind.type = LabelType::UnicodeString;
        kind.length = static_cast<std::uint32_t>((size - std::min(size, terminator)) / 2);
        return size >= terminator ? std::optional{kind} : std::nullopt;
    default:
        return std::nullopt;
    }
    return size == size_of(kind) ? std::optional{kind} : std::nullopt;
}

/// A label that was resolved.
struct Known {
    std::string name;
    LabelKind kind;
    /// Bytes of its value in the protocol.
    std::size_t wire_size{0};
};

/// A request, and the parts of it that have no answer.
struct Job {
    std::unique_ptr<LabelRequest> request;
    std::deque<Part> waiting;
    std::map<std::uint64_t, Part> sent;
    std::uint32_t messages{0};
    LabelStatus status{LabelStatus::Done};
    /// The owner is gone, and nobody waits.
    bool is_dropped{false};
};

/// Addresses have the number of the connection, so that those of an earlier one are noticed.
constexpr unsigned epoch_shift = 32;

class LabelsLine final : public detail::SlmpLine {
public:
    using Answered = std::function<void(SlmpEvent&)>;

    LabelsLine(const SlmpProtocolOptions& options, detail::SlmpFindings& findings, TimePoint now,
               LabelsLine*& present, Answered answered)
        : SlmpLine{options, findings, now}, present_{present}, answered_{std::move(answered)}
    {
        present_ = this;
    }
    LabelsLine(const LabelsLine&) = delete;
    LabelsLine& operator=(const LabelsLine&) = delete;
    ~LabelsLine() override { present_ = nullptr; }

    Result<void> send(const PlanRequest& /*request*/, TimePoint /*now*/) override
    {
        return fail(status::Bad_NotSupported);
    }
    [[nodiscard]] std::optional<DeviceAnswer> next_answer() override
    {
        look();
        return std::nullopt;
    }

private:
    void answered(SlmpEvent event) override { answered_(event); }

    LabelsLine*& present_;
    Answered answered_;
};

} // namespace

struct SlmpLabels::Impl {
    class Protocol final : public DeviceProtocol {
    public:
        explicit Protocol(Impl& impl) : impl_{impl} {}

        [[nodiscard]] PlanConfig plan() const override { return {}; }
        [[nodiscard]] std::unique_ptr<DeviceLine> connect(TimePoint now) override
        {
            return std::make_unique<LabelsLine>(impl_.options.protocol, impl_.findings, now,
                                                impl_.line,
                                                [this](SlmpEvent& event) { impl_.take(event); });
        }

    private:
        Impl& impl_;
    };

    Impl(SlmpLabelsOptions o, const WallClock& c, TimePoint (*n)(), LogSink& log)
        : options{std::move(o)}, clock{&c}, now{n}, findings{detail::findings_of(options.protocol)},
          device{options.device, std::make_unique<Protocol>(*this), log}
    {
        device.on_change([this] { look(); });
    }

    [[nodiscard]] const Known* known_at(std::uint64_t address) const;
    [[nodiscard]] std::size_t labels_of(const LabelRequest& request) const;
    [[nodiscard]] std::size_t cost_of(const LabelRequest& request, std::size_t index) const;
    [[nodiscard]] SlmpOperation operation_of(const LabelRequest& request, const Part& part) const;
    [[nodiscard]] bool has_valid_places(const LabelRequest& request) const;
    void divide();
    void begin();
    void work();
    void take(SlmpEvent& event);
    void take(const Part& part, const SlmpAnswer& answer);
    void refuse(const Part& part, std::uint16_t end_code);
    void finish();
    void look();
    void answer(std::unique_ptr<LabelRequest> request, LabelStatus status) const;

    SlmpLabelsOptions options;
    const WallClock* clock;
    TimePoint (*now)();
    detail::SlmpFindings findings;
    LabelsLine* line{nullptr};
    LabelListener* listener{nullptr};
    std::deque<std::unique_ptr<LabelRequest>> queue;
    std::optional<Job> job;
    /// The labels of this connection; the place is the low part of an address.
    std::vector<Known> known;
    std::map<std::string, std::uint64_t, std::less<>> addresses;
    std::uint64_t epoch{0};
    bool was_online{false};
    bool is_working{false};
    // Last: its line uses the others.
    Device device;
};

const Known* SlmpLabels::Impl::known_at(std::uint64_t address) const
{
    const std::uint64_t place = address & ((std::uint64_t{1} << epoch_shift) - 1);
    return address >> epoch_shift == epoch && place < known.size()
               ? &known[static_cast<std::size_t>(place)]
               : nullptr;
}

std::size_t SlmpLabels::Impl::labels_of(const LabelRequest& request) const
{
    return request.kind == LabelRequest::Kind::Resolve ? request.names.size()
                                                       : request.places.size();
}

std::size_t SlmpLabels::Impl::cost_of(const LabelRequest& request, std::size_t index) const
{
    constexpr std::size_t of_head = 8;
    if (request.kind == LabelRequest::Kind::Resolve) {
        return of_head + 2 * request.names[index].size();
    }
    const Known& label = *known_at(request.places[index].address);
    return of_head + 2 * label.name.size() + label.wire_size;
}

/// All places are of this connection and within the bytes.
bool SlmpLabels::Impl::has_valid_places(const LabelRequest& request) const
{
    return std::ranges::all_of(request.places, [&](const LabelPlace& place) {
        const Known* const label = known_at(place.address);
        return label != nullptr && place.size == size_of(label->kind) &&
               place.offset <= request.bytes.size() &&
               place.size <= request.bytes.size() - place.offset;
    });
}

/// Divides a request into parts within the limits.
void SlmpLabels::Impl::divide()
{
    const LabelRequest& request = *job->request;
    Part part;
    std::size_t cost = 0;
    for (std::size_t i = 0; i < labels_of(request); ++i) {
        const std::size_t more = cost_of(request, i);
        if (part.count == options.max_labels ||
            (part.count > 0 && cost + more > options.max_bytes)) {
            job->waiting.push_back(std::exchange(part, {i, 0}));
            cost = 0;
        }
        ++part.count;
        cost += more;
    }
    if (part.count > 0) {
        job->waiting.push_back(part);
    }
}

SlmpOperation SlmpLabels::Impl::operation_of(const LabelRequest& request, const Part& part) const
{
    SlmpOperation operation;
    const bool is_write = request.kind == LabelRequest::Kind::Write;
    operation.command = is_write ? SlmpCommand::LabelRandomWrite : SlmpCommand::LabelRandomRead;
    for (std::size_t i = part.first; i < part.first + part.count; ++i) {
        SlmpLabel& label = operation.labels.emplace_back();
        if (request.kind == LabelRequest::Kind::Resolve) {
            label.name = request.names[i];
            continue;
        }
        const LabelPlace& place = request.places[i];
        const Known& target = *known_at(place.address);
        label.name = target.name;
        if (is_write) {
            const auto value = std::span{request.bytes}.subspan(place.offset, place.size);
            label.data.assign(value.begin(), value.end());
            label.data.resize(target.wire_size); // zeros after a text
        }
    }
    return operation;
}

void SlmpLabels::Impl::answer(std::unique_ptr<LabelRequest> request, LabelStatus status) const
{
    request->status = status;
    request->time = clock->now();
    if (listener != nullptr) {
        listener->done(std::move(request));
    }
}

void SlmpLabels::Impl::finish()
{
    Job done = *std::exchange(job, std::nullopt);
    if (!done.is_dropped) {
        done.request->scans = std::max<std::uint32_t>(done.messages, 1);
        answer(std::move(done.request), done.status);
    }
}

/// Takes the next request; one that cannot be sent is answered.
void SlmpLabels::Impl::begin()
{
    job.emplace();
    job->request = std::move(queue.front());
    queue.pop_front();
    LabelRequest& request = *job->request;
    switch (request.kind) {
    case LabelRequest::Kind::Resolve:
        request.labels.assign(request.names.size(), ResolvedLabel{});
        break;
    case LabelRequest::Kind::Sample:
        job->status = request.places.empty() ? LabelStatus::Done : LabelStatus::SamplingUnknown;
        return;
    case LabelRequest::Kind::Read:
    case LabelRequest::Kind::Write:
        if (!has_valid_places(request)) {
            job->status = LabelStatus::Mismatch;
            return;
        }
        break;
    }
    divide();
}

/// Sends what can be sent. Writes stay in order, a message at a time.
void SlmpLabels::Impl::work()
{
    if (std::exchange(is_working, true)) {
        return;
    }
    while (line != nullptr && device.state() == DeviceState::Online) {
        if (!job && queue.empty()) {
            break;
        }
        if (!job) {
            begin();
        }
        const std::size_t most = job->request->kind == LabelRequest::Kind::Write
                                     ? 1
                                     : options.protocol.client.max_under_way;
        while (!job->waiting.empty() && job->sent.size() < most) {
            const Part part = job->waiting.front();
            job->waiting.pop_front();
            const auto sent = line->ask(operation_of(*job->request, part), now());
            if (sent) {
                job->sent.emplace(*sent, part);
                ++job->messages;
            } else {
                refuse(part, 0);
            }
        }
        if (!job->waiting.empty() || !job->sent.empty()) {
            break;
        }
        finish();
    }
    is_working = false;
}

void SlmpLabels::Impl::take(SlmpEvent& event)
{
    if (!job) {
        return;
    }
    const auto found = job->sent.extract(event.id);
    if (found.empty()) {
        return;
    }
    if (event.status.is_bad()) {
        job->status = LabelStatus::NoCommunication;
        job->waiting.clear();
    } else if (event.answer.end_code != 0) {
        refuse(found.mapped(), event.answer.end_code);
    } else {
        take(found.mapped(), event.answer);
    }
}

void SlmpLabels::Impl::take(const Part& part, const SlmpAnswer& answer)
{
    LabelRequest& request = *job->request;
    if (request.kind == LabelRequest::Kind::Write) {
        return;
    }
    for (std::size_t i = 0; i < part.count; ++i) {
        const SlmpLabelValue& value = answer.labels[i];
        const auto kind = kind_of(value);
        if (request.kind == LabelRequest::Kind::Resolve) {
            ResolvedLabel& label = request.labels[part.first + i];
            if (!kind) {
                label.error = LabelError::UnsupportedType;
                continue;
            }
            const std::string& name = request.names[part.first + i];
            const auto [at, is_new] =
                addresses.try_emplace(name, epoch << epoch_shift | known.size());
            if (is_new) {
                known.push_back({name, *kind, value.data.size()});
            }
            label = {.error = LabelError::None, .kind = *kind, .address = at->second};
            continue;
        }
        const LabelPlace& place = request.places[part.first + i];
        const Known& label = *known_at(place.address);
        if (!kind || !(*kind == label.kind)) {
            job->status = LabelStatus::Mismatch; // another program is in the PLC
            job->waiting.clear();
            return;
        }
        const auto to = std::span{request.bytes}.subspan(place.offset, place.size);
        std::ranges::fill(to, std::byte{});
        std::copy_n(value.data.begin(), std::min<std::size_t>(to.size(), value.data.size()),
                    to.begin());
        if (label.kind.type == LabelType::Bit) {
            to.front() &= std::byte{1};
        }
    }
}

/// The PLC refuses a message as a whole. Names are asked for in halves until the one is found that
/// it does not have; values are all or none.
void SlmpLabels::Impl::refuse(const Part& part, std::uint16_t end_code)
{
    LabelRequest& request = *job->request;
    const SlmpFault fault = slmp_end_code(end_code).fault;
    if (request.kind != LabelRequest::Kind::Resolve) {
        job->status = end_code != 0 && fault == SlmpFault::State ? LabelStatus::NoCommunication
                                                                 : LabelStatus::Mismatch;
        job->waiting.clear();
    } else if (part.count > 1) {
        const std::size_t half = part.count / 2;
        job->waiting.push_front({part.first + half, part.count - half});
        job->waiting.push_front({part.first, half});
    } else {
        request.labels[part.first].error =
            end_code == 0 ? LabelError::NotAName : LabelError::Unknown;
    }
}

/// The device has changed: answers have come, or the connection has.
void SlmpLabels::Impl::look()
{
    const bool is_online = device.state() == DeviceState::Online;
    if (is_online && !std::exchange(was_online, true)) {
        ++epoch;
        known.clear();
        addresses.clear();
        if (listener != nullptr) {
            listener->labels_changed();
        }
    }
    if (!is_online) {
        was_online = false;
        if (job) {
            job->status = LabelStatus::NoCommunication;
            finish();
        }
        for (auto& request : std::exchange(queue, {})) {
            answer(std::move(request), LabelStatus::NoCommunication);
        }
        return;
    }
    work();
}

SlmpLabels::SlmpLabels(SlmpLabelsOptions options, const WallClock& clock, TimePoint (*now)(),
                       LogSink& log)
    : impl_{std::make_unique<Impl>(std::move(options), clock, now, log)}
{
}

SlmpLabels::~SlmpLabels()
{
    impl_->device.on_change({});
}

Device& SlmpLabels::device()
{
    return impl_->device;
}

void SlmpLabels::start(std::unique_ptr<LabelRequest> request)
{
    if (impl_->device.state() != DeviceState::Online) {
        impl_->answer(std::move(request), LabelStatus::NoCommunication);
        return;
    }
    if (impl_->queue.size() >= impl_->options.max_waiting) {
        impl_->answer(std::move(request), LabelStatus::TooManyOperations);
        return;
    }
    impl_->queue.push_back(std::move(request));
    impl_->work();
    impl_->device.flush(impl_->now());
}

void SlmpLabels::attach(LabelListener* listener)
{
    impl_->listener = listener;
    if (listener == nullptr) {
        impl_->queue.clear();
        if (impl_->job) {
            impl_->job->is_dropped = true;
        }
    }
}

} // namespace busbar::backend
