"""README's code and the type stubs."""

import ast
import inspect
import re
from pathlib import Path

import backstop
import pytest
from backstop import lab

FOLDER = Path(__file__).parents[1]


def blocks() -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", (FOLDER / "README.md").read_text(), re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("number", range(len(blocks())))
def test_the_code_of_the_readme_runs(number: int) -> None:
    exec(compile(blocks()[number], f"README.md, block {number + 1}", "exec"), {})


def members(owner: object) -> set[str]:
    return {name for name in vars(owner) if not name.startswith("_")}


@pytest.mark.parametrize("module, stub", [(backstop, "__init__.pyi"), (lab, "lab.pyi")])
def test_stubs_name_what_there_is(module: object, stub: str) -> None:
    tree = ast.parse((FOLDER / "python/backstop" / stub).read_text())
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    public = set(module.__all__)  # type: ignore[attr-defined]
    assert public == set(classes) | functions | ({"__version__", "lab"} if module is backstop else set())
    for name, node in classes.items():
        if name != "Error":
            declared = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            declared = {item for item in declared if not item.startswith("_")}
            assert declared == members(getattr(module, name)), name


@pytest.mark.parametrize("owner", [backstop.World, backstop.Shape, backstop.Scene, lab.Problem])
def test_everything_has_a_docstring(owner: type) -> None:
    assert inspect.getdoc(owner)
    for name in members(owner):
        assert inspect.getdoc(getattr(owner, name)), name
