#include <algorithm>
#include <memory>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"
#include "open_files.hpp"
#include "transfer_nodes.hpp"

// What the Methods of a TemporaryFileTransferType and of its files do (Part 20, 4.2 and 4.4).

namespace busbar::administration::detail {

using server::MethodCall;

namespace {

// Reasons, see CallResult::reason.

constexpr const char* no_such_file =
    "this session has no such file: it was closed, timed out, or gave its place to another user";
constexpr const char* no_room =
    "too many file transfers are in progress; try again when they are done";

TransferRequest request_of(const MethodCall& call, const Variant& options)
{
    return {options, call.user(), call.session_id(), &call.method_id()};
}

} // namespace

const std::array<TransferNodes::Declared, 9> TransferNodes::declared{{
    {id::TemporaryFileTransferType_GenerateFileForRead, &TransferNodes::generate_for_read, false},
    {id::TemporaryFileTransferType_GenerateFileForWrite, &TransferNodes::generate_for_write, true},
    {id::TemporaryFileTransferType_CloseAndCommit, &TransferNodes::close_and_commit, true},
    {id::FileType_Open, &TransferNodes::open, false},
    {id::FileType_Close, &TransferNodes::close, false},
    {id::FileType_Read, &TransferNodes::read_file, false},
    {id::FileType_Write, &TransferNodes::write_file, true},
    {id::FileType_GetPosition, &TransferNodes::get_position, false},
    {id::FileType_SetPosition, &TransferNodes::set_position, false},
}};

std::string_view TransferNodes::name_of(const NodeId& object) const
{
    if (object.namespace_index() != namespace_ || object.id_type() != IdType::String) {
        return {};
    }
    const std::string_view text = object.string().view();
    return text.substr(std::min(text.size(), text.rfind('/') + 1));
}

/// Finds the session's file that the Object and the handle denote.
TransferFile* TransferNodes::file_of(const MethodCall& call)
{
    const std::string_view name = name_of(call.object_id());
    TransferFile* const file =
        files_.find(call.input<std::uint32_t>(0), holder_of(server_, call), name, now());
    return file != nullptr && call.object_id() == node_id(name) ? file : nullptr;
}

void TransferNodes::serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index)
{
    expire();
    MethodCall call{batch, index};
    const auto which = static_cast<std::size_t>(batch->items()[index].handle);
    if (which >= declared.size()) {
        return call.fail(status::Bad_MethodInvalid);
    }
    (this->*declared[which].method)(call);
}

void TransferNodes::generate_for_read(MethodCall& call)
{
    const auto room = files_.room(holder_of(server_, call));
    if (!room) {
        return call.fail(room.error(), no_room);
    }
    auto bytes = transfer_.owner->generate(request_of(call, call.inputs()[0]), *room);
    if (!bytes) {
        return call.fail(bytes.error(), transfer_.owner->why_refused());
    }
    if (bytes->size() > *room) {
        return call.fail(status::Bad_EncodingLimitsExceeded,
                         "the file would be larger than " + std::to_string(*room) + " bytes");
    }
    auto kept = keep({.holder = holder_of(server_, call),
                      .bytes = std::make_shared<std::vector<std::byte>>(*std::move(bytes))});
    if (!kept) {
        return call.fail(kept.error());
    }
    call.succeed(*std::move(kept));
}

void TransferNodes::generate_for_write(MethodCall& call)
{
    if (const auto room = files_.room_to_write(holder_of(server_, call)); !room) {
        return call.fail(room.error(), no_room);
    }
    const Variant& options = call.inputs()[0];
    const TransferRequest request = request_of(call, options);
    if (const StatusCode may = transfer_.owner->may_take(request); may.is_bad()) {
        return call.fail(may, transfer_.owner->why_refused());
    }
    auto kept = keep({.holder = holder_of(server_, call), .is_written = true, .options = options});
    if (!kept) {
        return call.fail(kept.error());
    }
    call.succeed(*std::move(kept));
}

void TransferNodes::close_and_commit(MethodCall& call)
{
    TransferFile* const file =
        files_.find(call.input<std::uint32_t>(0), holder_of(server_, call), now());
    if (file == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_such_file);
    }
    if (!file->is_written || file->is_being_taken) {
        return call.fail(status::Bad_InvalidState, file->is_written
                                                       ? "the file is already being processed"
                                                       : "the file is for reading");
    }
    const TransferRequest request = request_of(call, file->options);
    auto outputs = one_output(Variant{NodeId{}});
    const StatusCode may = transfer_.owner->may_take(request);
    if (may.is_good() && is_taking_) {
        return call.fail(status::Bad_TooManyOperations,
                         "another file is being processed; try again when it is done");
    }
    auto preparation = may.is_bad() ? std::function<void()>{}
                                    : transfer_.owner->preparation(request, *file->bytes);
    if (!preparation) {
        const StatusCode taken = may.is_bad() ? may : transfer_.owner->take(request, *file->bytes);
        return end_taking(call, file, taken, std::move(outputs), transfer_.owner->why_refused());
    }
    // The session, and with it the file, may end during the work, the right to send it may be lost,
    // and a client that was answered, as by a shutdown, must find that nothing has changed.
    const auto kept = std::make_shared<MethodCall>(std::move(call));
    const auto work = [bytes = file->bytes, prepare = std::move(preparation)] { prepare(); };
    const auto end = [this, kept, holder = holder_of(server_, *kept), outputs = std::move(outputs),
                      handle = file->handle, options = file->options,
                      bytes = file->bytes](StatusCode done) mutable {
        is_taking_ = false;
        std::string reason;
        TransferFile* const prepared = files_.find(handle);
        if (prepared != nullptr) {
            prepared->is_being_taken = false;
        }
        if (done.is_good() && kept->is_abandoned()) {
            done = status::Bad_Timeout;
        }
        if (done.is_good()) {
            done = check_still(server_, holder, kept->object_id(), kept->method_id());
        }
        if (done.is_good()) {
            done = transfer_.owner->take(request_of(*kept, options), *bytes);
            reason = transfer_.owner->why_refused();
        }
        end_taking(*kept, prepared, done, std::move(outputs), std::move(reason));
    };
    is_taking_ = true;
    file->is_being_taken = true;
    table_.run(worker_, work, end);
}

void TransferNodes::end_taking(MethodCall& call, TransferFile* file, StatusCode taken,
                               Array<Variant> outputs, std::string reason)
{
    if (taken.is_bad()) {
        return call.fail(taken, std::move(reason)); // the client keeps the file
    }
    if (file != nullptr) {
        file->deadline = TimePoint::min(); // the next call removes the file
        busbar::detail::attempt([&] { drop(*file); });
    }
    call.succeed(std::move(outputs));
}

/// Refuses: the client that requested the file already has it open (Part 20, 4.4.3).
void TransferNodes::open(MethodCall& call)
{
    call.fail(status::Bad_InvalidState, "the file is already open");
}

/// Discards the file; only CloseAndCommit keeps it.
void TransferNodes::close(MethodCall& call)
{
    const TransferFile* const file = file_of(call);
    if (file == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_such_file);
    }
    drop(*file);
    call.succeed();
}

void TransferNodes::read_file(MethodCall& call)
{
    TransferFile* const file = file_of(call);
    if (file == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_such_file);
    }
    // Restore the position if the client does not get the answer.
    busbar::detail::Undo undo{[file, before = file->position] { file->position = before; }};
    const auto bytes = TransferFiles::read(*file, call.input<std::int32_t>(1));
    if (!bytes) {
        return call.fail(bytes.error());
    }
    auto outputs = one_output(Variant{ByteString{*bytes}});
    undo.keep();
    call.succeed(std::move(outputs));
}

void TransferNodes::write_file(MethodCall& call)
{
    TransferFile* const file = file_of(call);
    if (file == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_such_file);
    }
    if (const StatusCode written = files_.write(*file, bytes_input(call, 1)); written.is_bad()) {
        return call.fail(written,
                         "the file is open for reading, is being processed, or would be too large");
    }
    file->modified = clock_.now();
    call.succeed();
}

void TransferNodes::get_position(MethodCall& call)
{
    const TransferFile* const file = file_of(call);
    if (file == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_such_file);
    }
    call.succeed(one_output(Variant{std::uint64_t{file->position}}));
}

void TransferNodes::set_position(MethodCall& call)
{
    TransferFile* const file = file_of(call);
    if (file == nullptr) {
        return call.fail(status::Bad_InvalidArgument, no_such_file);
    }
    TransferFiles::set_position(*file, call.input<std::uint64_t>(1));
    call.succeed();
}

DataValue TransferNodes::value_of(const TransferFile& file, FileAspect aspect) const
{
    switch (aspect) {
    case FileAspect::Size:
        return DataValue{Variant{std::uint64_t{file.bytes->size()}}};
    case FileAspect::OpenCount:
        return DataValue{Variant{std::uint16_t{1}}};
    case FileAspect::MaxByteStringLength:
        return DataValue{Variant{max_piece(server_)}};
    case FileAspect::LastModifiedTime:
        return DataValue{Variant{file.modified}};
    default:
        return DataValue{Variant{file.is_written}};
    }
}

void TransferNodes::read(server::ReadBatch batch)
{
    const TimePoint time = now();
    constexpr auto count = static_cast<std::uint64_t>(FileAspect::Count);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const std::uint64_t handle = batch.items()[i].handle;
        const auto number = static_cast<std::size_t>(handle / count);
        const TransferFile* const file = number < numbers_.size() && !numbers_[number].empty()
                                             ? files_.find(numbers_[number], time)
                                             : nullptr;
        DataValue value{status::Bad_NodeIdUnknown};
        if (file != nullptr) {
            value = value_of(*file, static_cast<FileAspect>(handle % count));
            value.source_timestamp = clock_.now();
        }
        batch.results()[i] = std::move(value);
    }
    batch.complete();
}

} // namespace busbar::administration::detail
