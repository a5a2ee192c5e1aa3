#!/bin/sh
# Programs in the formats of development systems, recognized by their content, with constants and
# expressions in them.
# usage: formats_test.sh CONTROLLER BUSBAR
set -u
controller=$1 busbar=$2
. "$(dirname "$0")/functions.sh"

{
    server "$port" pki
    machine 'mode = "RUN"'
} > controller.toml

# Declarations: constants and enumerations before and after they are used.
cat > declared <<'END'
{attribute 'publish' := 'publish only'}
VAR_GLOBAL
    Speed : INT := (N + 1) * 5 MOD 16#1F;
    Trace : ARRAY [1..N-1] OF INT := [N-1(SHL(1, N))];
    Next : Mode := Run;
    Level : INT := Mode.Stop;
    Bad : INT := 1 / (N - 4);
    Loop : INT := A;
END_VAR
TYPE Mode : (Idle := N, Run, Stop := Run * 10); END_TYPE
VAR_GLOBAL CONSTANT
    A : INT := B;
    B : INT := A + 1;
    N : INT := 4;
END_VAR
END
"$controller" --check declared > out 2>&1
says '4 variables are published'
says 'not published  Bad .*7:20: variable Bad: the operation ./. divides by zero'
says 'not published  Loop .*depends on itself: '
cp declared press.st
begin pki --config controller.toml
value Speed 25
value Level 50
value Trace '\[16, 16, 16\]'
value Next Run

# IEC 61131-10 as Sysmac Studio writes it.
cat > sysmac <<'END'
<?xml version="1.0"?>
<Project xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:smcext="https://www.ia.omron.com/Smc" schemaVersion="1" xmlns="www.iec.ch/public/TC65SC65BWG7TF10">
  <Types><GlobalNamespace /></Types>
  <Instances><Configuration name="Line"><Resource name="Main" resourceTypeName="">
    <GlobalVars>
      <Variable name="Speed">
        <AddData><Data name="smc" handleUnknown="discard"><smcext:GlobalVariableAdditionalProperties networkPublish="Output" /></Data></AddData>
        <Type><TypeName>INT</TypeName></Type>
        <InitialValue><SimpleValue value="Limit - 1" /></InitialValue>
        <Address address="%W461.00" />
      </Variable>
    </GlobalVars>
    <GlobalVars constant="true">
      <Variable name="Limit"><Type><TypeName>INT</TypeName></Type><InitialValue><SimpleValue value="100" /></InitialValue></Variable>
    </GlobalVars>
  </Resource></Configuration></Instances>
</Project>
END
"$controller" --check sysmac > out 2>&1 || fail "IEC 61131-10 is refused"
says '1 variables are published'
cp sysmac press.st
power_cycle
value Speed 99

# A list of variables of TwinCAT, with its lines.
cat > list <<'END'
<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <GVL Name="GVL" Id="{0}">
    <Declaration><![CDATA[{attribute 'OPC.UA.DA' := '1'}
VAR_GLOBAL
    Speed : INT := GVL.Limit / 2;
    Tick : POINTER TO INT;
END_VAR
VAR_GLOBAL CONSTANT Limit : INT := 12; END_VAR]]></Declaration>
  </GVL>
</TcPlcObject>
END
"$controller" --check list > out 2>&1
says 'not published  Tick .*7:12: variable Tick: is of the type POINTER'
grep -v Tick list > press.st
power_cycle
value Speed 6

# PLCopen XML of the first version.
sed -e 's/^<Project.*>/<project xmlns="http:\/\/www.plcopen.org\/xml\/tc6.xsd">/' \
    -e 's/<\/Project>/<\/project>/' -e 's/<TypeName>INT<\/TypeName>/<INT\/>/' sysmac > first
"$controller" --check first > out 2>&1 || fail "PLCopen XML 1.0 is refused"
finish
