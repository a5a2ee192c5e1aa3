#include <chrono>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include <busbar/core/detail/guarded.hpp>

#include "server.hpp"

/// A batch of the server with its items in C. The items' room is taken before the program is asked.
struct busbar_batch {
    explicit busbar_batch(busbar::server::ReadBatch&& of) : batch{std::move(of)} {}
    explicit busbar_batch(busbar::server::WriteBatch&& of) : batch{std::move(of)} {}

    std::variant<busbar::server::ReadBatch, busbar::server::WriteBatch> batch;
    std::vector<busbar_read_item> reads;
    std::vector<busbar_write_item> writes;
    /// The items of the batch that `writes` are: some have values that there is no form of in C.
    std::vector<std::size_t> places;
    busbar::c::Scratch scratch;
};

namespace busbar::c {

namespace {

void fill(server::ReadSlot& slot, const busbar_data_value& from)
{
    slot.status = StatusCode{from.status};
    slot.source_timestamp = DateTime{from.source_time};
    if (slot.status.is_bad()) {
        return;
    }
    const StatusCode thrown = busbar::detail::caught([&] {
        auto value = to_variant(from.value);
        slot.status = value ? slot.status : status::Bad_InternalError;
        slot.value = value ? *std::move(value) : Variant{};
    });
    slot.status = thrown.is_bad() ? thrown : slot.status;
}

/// Hands the results to the server; all are `status` if that is bad.
void complete(busbar_batch& of, StatusCode status)
{
    if (auto* const reads = std::get_if<server::ReadBatch>(&of.batch)) {
        for (std::size_t i = 0; i < of.reads.size() && !status.is_bad(); ++i) {
            fill(reads->results()[i], of.reads[i].result);
        }
        status.is_bad() ? reads->fail(status) : reads->complete();
        return;
    }
    auto& writes = std::get<server::WriteBatch>(of.batch);
    for (std::size_t i = 0; i < of.writes.size() && !status.is_bad(); ++i) {
        writes.results()[of.places[i]] = StatusCode{of.writes[i].result};
    }
    if (status.is_bad()) {
        for (const std::size_t place : of.places) {
            writes.results()[place] = status;
        }
    }
    writes.complete();
}

class CallbackSource final : public server::DataSource {
public:
    explicit CallbackSource(const busbar_source& of) : of_{of} {}

    [[nodiscard]] server::DataSourceOptions options() const override
    {
        server::DataSourceOptions options;
        options.all_or_nothing = of_.all_or_nothing;
        if (of_.timeout_ms != 0) {
            options.timeout = std::chrono::milliseconds{of_.timeout_ms};
        }
        return options;
    }
    void read(server::ReadBatch batch) override;
    void write(server::WriteBatch batch) override;

private:
    /// Completes a batch unless busbar_batch_complete does, which another thread may have called.
    static void answer(busbar_batch* batch, busbar_status status)
    {
        if (status != BUSBAR_GOOD_COMPLETES_ASYNCHRONOUSLY) {
            complete(*std::unique_ptr<busbar_batch>{batch}, StatusCode{status});
        }
    }

    busbar_source of_;
};

void CallbackSource::read(server::ReadBatch batch)
{
    auto made = std::make_unique<busbar_batch>(std::move(batch));
    for (const server::ReadItem& item : std::get<server::ReadBatch>(made->batch).items()) {
        busbar_read_item in_c{};
        in_c.handle = item.handle;
        in_c.result.status = BUSBAR_BAD_NO_COMMUNICATION;
        made->reads.push_back(in_c);
    }
    busbar_batch* const in_c = made.release();
    answer(in_c, of_.read(of_.context, in_c, in_c->reads.data(), in_c->reads.size()));
}

void CallbackSource::write(server::WriteBatch batch)
{
    if (of_.write == nullptr) {
        return batch.finish(status::Bad_NotWritable);
    }
    auto made = std::make_unique<busbar_batch>(std::move(batch));
    auto& writes = std::get<server::WriteBatch>(made->batch);
    for (std::size_t i = 0; i < writes.size(); ++i) {
        busbar_write_item in_c{};
        in_c.handle = writes.items()[i].handle;
        in_c.result = BUSBAR_BAD_NO_COMMUNICATION;
        if (to_c(*writes.items()[i].data, made->scratch, in_c.value).is_bad()) {
            writes.results()[i] = status::Bad_NotSupported;
            continue;
        }
        made->writes.push_back(in_c);
        made->places.push_back(i);
    }
    const bool is_partial = made->writes.size() < writes.size();
    if (made->writes.empty() || (is_partial && of_.all_or_nothing)) {
        return writes.finish(status::Bad_NotSupported);
    }
    busbar_batch* const in_c = made.release();
    answer(in_c, of_.write(of_.context, in_c, in_c->writes.data(), in_c->writes.size()));
}

} // namespace

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_server_add_source(busbar_server* server, const busbar_source* source,
                                       uint32_t* number)
{
    return c::change(server, [&]() -> StatusCode {
        if (source == nullptr || source->size != sizeof *source || source->read == nullptr ||
            number == nullptr) {
            return status::Bad_InvalidArgument;
        }
        server->sources.reserve(server->sources.size() + 1);
        *number = server->server->add_source(std::make_shared<c::CallbackSource>(*source));
        server->sources.push_back(*number);
        return status::Good;
    });
}

busbar_status busbar_batch_complete(busbar_batch* batch, busbar_status status)
{
    if (batch == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    const std::unique_ptr<busbar_batch> owned{batch};
    return c::run_guarded(nullptr, [&] {
        c::complete(*owned, StatusCode{status});
        return status::Good;
    });
}
