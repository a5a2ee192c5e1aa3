#include "wire.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace busbar::backend {

namespace {

using detail::ModbusForm;
using Function = ModbusFunction;

constexpr std::array modbus_forms{
    ModbusForm{Function::ReadCoils, true, max_modbus_read_bits, 0, false},
    ModbusForm{Function::ReadDiscreteInputs, true, max_modbus_read_bits, 0, false},
    ModbusForm{Function::ReadHoldingRegisters, false, max_modbus_read_registers, 0, false},
    ModbusForm{Function::ReadInputRegisters, false, max_modbus_read_registers, 0, false},
    ModbusForm{Function::WriteCoil, true, 0, 1, true},
    ModbusForm{Function::WriteRegister, false, 0, 1, true},
    ModbusForm{Function::WriteCoils, true, 0, max_modbus_write_coils, false},
    ModbusForm{Function::WriteRegisters, false, 0, max_modbus_write_registers, false},
    ModbusForm{Function::MaskWriteRegister, false, 0, 0, false},
    ModbusForm{Function::ReadWriteRegisters, false, max_modbus_read_registers,
               max_modbus_read_write_registers, false},
    ModbusForm{Function::ReadDeviceIdentification, false, 0, 0, false},
};

struct ModbusExceptionRow {
    ModbusException exception;
    StatusCode status;
    bool is_refusal;
    std::string_view text;
};

constexpr std::array modbus_exceptions{
    ModbusExceptionRow{ModbusException::IllegalFunction, status::Bad_NotSupported, true,
                       "function not served"},
    ModbusExceptionRow{ModbusException::IllegalDataAddress, status::Bad_ConfigurationError, true,
                       "address not available"},
    ModbusExceptionRow{ModbusException::IllegalDataValue, status::Bad_OutOfRange, true,
                       "value or quantity not allowed"},
    ModbusExceptionRow{ModbusException::DeviceFailure, status::Bad_DeviceFailure, false,
                       "device failure"},
    ModbusExceptionRow{ModbusException::Acknowledge, status::Bad_ResourceUnavailable, false,
                       "accepted, completes later"},
    ModbusExceptionRow{ModbusException::DeviceBusy, status::Bad_ResourceUnavailable, false,
                       "device busy"},
    ModbusExceptionRow{ModbusException::NegativeAcknowledge, status::Bad_RequestNotAllowed, true,
                       "not allowed"},
    ModbusExceptionRow{ModbusException::MemoryParityError, status::Bad_DeviceFailure, false,
                       "memory parity error"},
    ModbusExceptionRow{ModbusException::GatewayPathUnavailable, status::Bad_NoCommunication, false,
                       "gateway has no path to the unit"},
    ModbusExceptionRow{ModbusException::GatewayTargetSilent, status::Bad_NoCommunication, false,
                       "unit does not answer the gateway"},
};

const ModbusExceptionRow* row_of(ModbusException exception)
{
    const auto row =
        std::ranges::find(modbus_exceptions, exception, &ModbusExceptionRow::exception);
    return row == modbus_exceptions.end() ? nullptr : row;
}

} // namespace

const ModbusForm* detail::modbus_form(std::uint8_t function)
{
    const auto form = std::ranges::find(modbus_forms, static_cast<ModbusFunction>(function),
                                        &ModbusForm::function);
    return form == modbus_forms.end() ? nullptr : form;
}

bool is_known(ModbusFunction function)
{
    return detail::modbus_form(static_cast<std::uint8_t>(function)) != nullptr;
}

bool is_write(ModbusFunction function)
{
    const ModbusForm* const form = detail::modbus_form(static_cast<std::uint8_t>(function));
    return form != nullptr &&
           (form->max_write != 0 || function == ModbusFunction::MaskWriteRegister);
}

StatusCode status_of(ModbusException exception, ModbusFunction function)
{
    if (exception == ModbusException::Acknowledge && is_write(function)) {
        return status::Good_CompletesAsynchronously;
    }
    const ModbusExceptionRow* const row = row_of(exception);
    return row == nullptr ? status::Bad_UnknownResponse : row->status;
}

bool is_refusal(ModbusException exception)
{
    const ModbusExceptionRow* const row = row_of(exception);
    return row != nullptr && row->is_refusal;
}

std::string text_of(ModbusException exception)
{
    const ModbusExceptionRow* const row = row_of(exception);
    return "exception " + std::to_string(static_cast<unsigned>(exception)) + " (" +
           std::string{row == nullptr ? "not defined" : row->text} + ")";
}

} // namespace busbar::backend
