import pytest
from gemheads.models.heads.compose import MOST, SHARES
from gemheads.models.heads.people import AVATARS, Person


@pytest.mark.parametrize("person", AVATARS, ids=lambda person: person.name)
@pytest.mark.parametrize("hairs", SHARES)
def test_the_most_hairs_leave_an_avatar_as_it_is(person: Person, hairs: str) -> None:
    assert int(SHARES[hairs] * person.splats) < MOST[hairs]
